#include "engine/studies/trajectory.h"

#include <cmath>
#include <limits>

#include "engine/base/errors.h"
#include "engine/core/equations/configuration.h"
#include "engine/session/world/part_table.h"

namespace truestep {

std::vector<double> field_values(const System& system, const State& state, const std::string& name) {
  if (name == "state") return configuration(state);
  if (const auto at = system.find_field(name)) {
    std::vector<double> scratch;
    const FieldView v = system.field(state, at->part, at->field, scratch);
    std::vector<double> out(v.rows * v.width);
    for (size_t k = 0; k < out.size(); ++k) out[k] = element(v, k);
    return out;
  }
  std::string names = "state";
  for (const PartInfo& part : system.parts()) {
    for (const FieldInfo& f : part.fields) names += ", " + f.name;
  }
  throw Error(
      "scene_invalid", "the system has no field \"" + name + '"',
      {"/quantity", "unknown_field", "the system has no such field", '"' + name + '"', names, "", ""});
}

Trace trace(const World& world, const TraceRequest& request, const StudyContext& context) {
  static const ThreadArena kSerial(1);
  Trace out;
  WorldState state = world.initial_state();
  Workspace workspace;
  const System& system = world.system(request.field.system);
  const auto sample = [&] {
    out.times.push_back(static_cast<double>(state.step) * world.dt());
    out.values.push_back(field_values(system, state.systems[request.field.system], request.field.name));
    if (request.observables.empty()) return;
    Observables now;
    system.observe(state.systems[request.field.system], out.times.back(), now);
    auto& row = out.observed.emplace_back();
    for (const std::string& name : request.observables)
      row.push_back(now.find(name).value_or(std::numeric_limits<double>::quiet_NaN()));
  };
  sample();
  uint64_t largest_batch = 1;  // steps between two checks of the clock and the limits
  for (size_t i = 0; i < request.samples; ++i) {
    uint64_t left = request.steps_per_sample;
    while (left > 0) {
      context.check();
      const uint64_t batch = std::min(left, largest_batch);
      const double before = thread_cpu_seconds();
      try {
        for (uint64_t k = 0; k < batch; ++k) world.step(state, workspace, kSerial, {});
      } catch (const Instability& e) {
        out.end = Trace::End::unstable;
        out.detail = e.what();
      }
      const double took = thread_cpu_seconds() - before;
      if (took < 0.005 && largest_batch < 1 << 20) largest_batch *= 2;
      out.cpu_seconds += took;
      out.steps = state.step;
      if (out.end == Trace::End::unstable) return out;
      if (out.cpu_seconds > request.cpu_limit || std::chrono::steady_clock::now() >= context.deadline) {
        out.end = Trace::End::over_budget;
        out.detail = "the run exceeded its share of the time budget";
        return out;
      }
      left -= batch;
    }
    sample();
  }
  return out;
}

double relative_error(const std::vector<double>& a, const std::vector<double>& b, double least) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double difference = 0, size = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double d = a[i] - b[i];
    difference += d * d;
    size += b[i] * b[i];
  }
  if (std::max(difference, size) < least * least) return 0;
  const double e = std::sqrt(difference / std::max(size, 1e-300));
  return std::isfinite(e) ? e : std::numeric_limits<double>::infinity();
}

double rounding_size(const std::vector<std::vector<double>>& values) {
  constexpr double kRounding = 1e-14;
  double largest = 0;
  for (const std::vector<double>& at : values) {
    double size = 0;
    for (const double x : at) size += x * x;
    largest = std::max(largest, size);
  }
  return kRounding * std::sqrt(largest);
}

}  // namespace truestep
