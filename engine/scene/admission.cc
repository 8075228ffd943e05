#include "engine/scene/admission.h"

#include <cstdio>

#include "engine/scene/params/params_bytes.h"

namespace truestep {

namespace {

std::string text(double v) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g", v);
  return buffer;
}

// Measured: what a session and each system take besides their contents.
constexpr double kSessionBytes = 13e3, kSystemBytes = 11.5e3;
// Measured: minimum time of a step, and of a substep of a system or coupling.
constexpr double kStepSeconds = 1e-6, kRoundSeconds = 2.5e-7;

}  // namespace

Cost estimate(const Scene& scene) {
  const auto systems = static_cast<double>(scene.systems.size());
  const double rounds =
      (systems + static_cast<double>(scene.couplings.size())) * static_cast<double>(scene.substeps());
  Cost sum{.workspace_bytes = kSessionBytes + kSystemBytes * systems,
           .seconds_per_step = kStepSeconds + kRoundSeconds * rounds};
  const auto add = [&](const Cost& c) {
    sum.state_bytes += c.state_bytes;
    sum.workspace_bytes += c.workspace_bytes;
    sum.elements += c.elements;
    const double seconds = c.seconds_per_step * static_cast<double>(scene.substeps());
    sum.seconds_per_step += seconds, sum.start_seconds += seconds * c.settles / scene.header.time.dt;
  };
  std::vector<Cost> own;
  for (const SceneSystem& s : scene.systems) {
    add(own.emplace_back(s.reading == Reading::sound ? s.row->cost(s.def.get()) : Cost{}));
    sum.workspace_bytes += heap_bytes(*s.row->table, s.def.get());
  }
  for (const SceneCoupling& c : scene.couplings) {
    if (c.reading == Reading::sound) add(c.row->cost(c.def.get(), own[c.a], own[c.b]));
  }
  return sum;
}

void require_admission(const Cost& cost, const AdmissionLimits& limits) {
  std::vector<Issue> issues;
  // Written so that a NaN estimate is refused too.
  const auto check = [&](const char* what, double value, double limit, const char* unit) {
    if (!(value <= limit)) {
      issues.push_back({"/systems", "quota",
                        std::string("the scene's estimated ") + what + " exceeds the limit", text(value),
                        "at most " + text(limit), "", unit});
    }
  };
  check("memory", cost.state_bytes + cost.workspace_bytes, limits.memory_bytes, "B");
  check("number of elements", cost.elements, limits.elements, "1");
  check("time per step", cost.seconds_per_step, limits.seconds_per_step, "s");
  check("time before the first step", cost.start_seconds, limits.start_seconds, "s");
  if (!issues.empty())
    throw Error("too_large", "the scene is larger than this server allows", std::move(issues));
}

}  // namespace truestep
