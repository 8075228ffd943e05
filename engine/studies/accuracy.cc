#include "engine/studies/accuracy.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/core/integrator.h"
#include "engine/scene/json_write.h"
#include "engine/session/expectation.h"
#include "engine/studies/scene_variant.h"
#include "engine/studies/work_precision.h"

namespace truestep {

namespace json = boost::json;

namespace {

// Of the tolerance, what a measured error may use: another machine's rounding and the rest of the path need
// some.
constexpr double kSafety = 0.5;

json::object describe(const WorkPoint& p) {
  const bool adaptive = find_integrator(p.integrator)->stepping == Integrator::Stepping::adaptive;
  return {{"integrator", p.integrator},
          {adaptive ? "tolerance" : "step", p.setting},
          {"error", std::isfinite(p.error_path) ? json::value(p.error_path) : json::value(nullptr)},
          {"cpu_seconds", p.cpu_seconds}};
}

bool finite_run(const WorkPoint& p) {
  return std::isfinite(p.error_path) && p.status != "over budget";
}

// Error of every point by an invariant: the largest relative drift of the energy over the horizon.
void judge_by_energy(const json::value& document, size_t system, double horizon,
                     std::vector<WorkPoint>& points, const StudyContext& context) {
  static const ThreadArena kSerial(1);
  for (WorkPoint& p : points) {
    if (!std::isfinite(p.cpu_seconds) || p.status == "unstable" || p.status == "over budget") continue;
    json::value d = document;
    set_integrator(d, system, p.integrator);
    const bool adaptive = find_integrator(p.integrator)->stepping == Integrator::Stepping::adaptive;
    if (adaptive)
      set_tolerance(d, system, p.setting);
    else
      set_dt(d, p.setting);
    Scene scene = require_scene(read_scene(d));
    ExpectParams drift;
    drift.quantity = "energy.drift";
    scene.header.expect = {drift};
    const auto steps = static_cast<uint64_t>(std::llround(horizon / scene.header.time.dt));
    const World world(std::move(scene));
    Expectations watch(world.scene());
    WorldState state = world.initial_state();
    Workspace workspace;
    watch.add(world.observe(state));
    const uint64_t every = std::max<uint64_t>(1, steps / 200);
    try {
      for (uint64_t n = 1; n <= steps; ++n) {
        if (n % 64 == 0) context.check();
        world.step(state, workspace, kSerial, {});
        if (n % every == 0) watch.add(world.observe(state));
      }
      p.error_path = watch.verdicts()[0].measured.value_or(INFINITY);
    } catch (const Instability&) {
      p.error_path = INFINITY;
    }
  }
}

// A horizon that no reference gets through is the scene's to change.
WorkMeasurement measured(const json::value& document, const WorkPrecisionParams& w, StudyContext& context) {
  try {
    return measure_work(document, w, context);
  } catch (const Error& e) {
    if (e.code() != "study_failed") throw;
    auto issues = e.issues();
    for (Issue& i : issues) i.pointer = "/accuracy" + i.pointer;
    throw Error("accuracy_unreachable",
                "the accuracy of this scene cannot be measured over its horizon in the time there is",
                std::move(issues));
  }
}

}  // namespace

AccuracyOutcome choose_method(const json::value& original, double budget, StudyContext& context) {
  const Scene scene = require_scene(read_scene(original));
  const AccuracyParams& wanted = scene.header.accuracy.value();
  const size_t system = studied_system(scene, wanted.system);
  const double dt = scene.header.time.dt;
  // The runs that are measured carry no companion of their own.
  json::value document = original;
  document.as_object().erase("accuracy");
  WorkPrecisionParams w;
  w.system = scene.systems[system].id;
  w.quantity = wanted.quantity;
  w.budget = budget;
  w.repeats = 1;
  // Whole session steps per sample, so that what is measured is what will run.
  const double horizon = wanted.horizon.value_or(scene.header.time.duration);
  const double steps = std::max(1.0, std::round(horizon / dt));
  w.samples = static_cast<int64_t>(std::min(16.0, steps));
  const double per_sample = std::ceil(steps / static_cast<double>(w.samples));
  w.horizon = per_sample * static_cast<double>(w.samples) * dt;
  for (int k = 0; k <= 9; ++k) w.steps.push_back(std::ldexp(dt, -k));
  w.adaptive_step = dt;
  WorkMeasurement m = measured(document, w, context);

  std::string judged_by = "path";
  const bool path_means_nothing = m.reference.meaningless() || m.reference.uncertainty > wanted.tolerance;
  if (path_means_nothing) {
    judged_by = "energy";
    judge_by_energy(document, system, m.horizon, m.points, context);
  }
  const WorkPoint *best = nullptr, *closest = nullptr;
  for (const WorkPoint& p : m.points) {
    if (!finite_run(p)) continue;
    if (!closest || p.error_path < closest->error_path) closest = &p;
    if (p.error_path <= kSafety * wanted.tolerance && (!best || p.cpu_seconds < best->cpu_seconds)) best = &p;
  }
  json::object report{{"tolerance", wanted.tolerance},
                      {"quantity", wanted.quantity},
                      {"horizon", m.horizon},
                      {"judged_by", judged_by},
                      {"reference", describe_reference(m.reference)}};
  if (path_means_nothing) {
    report["note"] =
        "two accurate methods part further than the tolerance before the horizon: the motion is chaotic or "
        "discontinuous, so single paths cannot be this accurate; methods are judged by the drift of the "
        "energy";
  }
  json::array runs;
  for (const WorkPoint& p : m.points) {
    if (finite_run(p)) runs.push_back(describe(p));
  }
  report["measured"] = std::move(runs);
  if (!best) {
    char text[32] = "nothing";
    if (closest)
      *std::to_chars(text, text + 31, closest->error_path, std::chars_format::scientific, 1).ptr = 0;
    throw Error("accuracy_unreachable",
                "no method meets the tolerance; the closest measured error is " + std::string(text),
                {{"/accuracy/tolerance", "unreachable",
                  closest ? closest->integrator + " comes closest" : "every method failed on this scene",
                  write_json(wanted.tolerance), "at least " + std::string(text), "", ""}});
  }
  AccuracyOutcome out{original, std::move(report)};
  out.report["chosen"] = describe(*best);
  set_integrator(out.scene, system, best->integrator);
  if (find_integrator(best->integrator)->stepping == Integrator::Stepping::adaptive)
    set_tolerance(out.scene, system, best->setting);
  else
    set_at(out.scene, "/time/substeps", static_cast<int64_t>(std::llround(dt / best->setting)));
  return out;
}

SettledScene settle_accuracy(const json::value& document, double budget, const ThreadArena& arena) {
  SettledScene settled{require_scene(read_scene(document)), {}};
  if (!settled.scene.header.accuracy) return settled;
  const std::atomic<bool> never{false};
  StudyContext context{.arena = arena, .cancelled = never, .progress = [](double, const std::string&) {}};
  AccuracyOutcome outcome = choose_method(document, budget, context);
  return {require_scene(read_scene(outcome.scene)), std::move(outcome.report)};
}

}  // namespace truestep
