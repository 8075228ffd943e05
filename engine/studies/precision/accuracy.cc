#include "engine/studies/precision/accuracy.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/core/equations/integrator.h"
#include "engine/integrators/table/integrators.h"
#include "engine/scene/json/json_write.h"
#include "engine/studies/precision/method_search.h"
#include "engine/studies/scene_variant.h"

namespace truestep {

namespace json = boost::json;

namespace {

using JudgedBy = MethodAnswer::JudgedBy;

bool is_adaptive(std::string_view integrator) {
  return find_integrator(integrator)->stepping == Integrator::Stepping::adaptive;
}

std::string rounded(double v) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, v, std::chars_format::scientific, 1).ptr};
}

json::object describe(const MeasuredMethod& p) {
  return {{"integrator", p.integrator},
          {is_adaptive(p.integrator) ? "tolerance" : "step", p.setting},
          {"error", std::isfinite(p.error) ? json::value(p.error) : json::value(nullptr)},
          {"cpu_seconds", p.cpu_seconds}};
}

// A field of the system; for a system that draws no points, "position" stands for its whole configuration.
std::string quantity_of(const AccuracyParams& wanted, const System& system) {
  std::string names = "state";
  for (const PartInfo& part : system.parts()) {
    if (part.find(wanted.quantity)) return wanted.quantity;
    for (const FieldInfo& f : part.fields) names += ", " + f.name;
  }
  if (wanted.quantity == "state" || wanted.quantity == "position") return "state";
  throw Error("scene_invalid", "the system has no field \"" + wanted.quantity + '"',
              {"/accuracy/quantity", "unknown_field", "the system has no such field",
               '"' + wanted.quantity + '"', names, "", ""});
}

// The best by order and structure when nothing could be measured: the best method for the system, a hundred
// times finer than requested.
std::optional<MeasuredMethod> promised(const json::value& document, size_t system, double tolerance,
                                       const StudyContext& context) {
  for (const char* name : {"dop853", "radau5", "dopri5"}) {
    json::value d = document;
    set_integrator(d, system, name);
    try {
      build_world(d, context);
    } catch (const Error&) {
      continue;
    }
    return MeasuredMethod{name, std::max(1e-13, 1e-2 * tolerance), INFINITY, 0};
  }
  return std::nullopt;
}

const MeasuredMethod* closest(const std::vector<MeasuredMethod>& measured) {
  const MeasuredMethod* best = nullptr;
  for (const MeasuredMethod& p : measured) {
    if (std::isfinite(p.error) && (!best || p.error < best->error)) best = &p;
  }
  return best;
}

[[noreturn]] void refuse(double tolerance, const MethodAnswer& answer) {
  const MeasuredMethod* nearest = closest(answer.measured);
  std::string detail = "no method completes this scene, so no accuracy can be guaranteed",
              message = "every method failed on this scene", reachable;
  if (nearest) {
    detail = "no method meets the tolerance; the closest measured error is " + rounded(nearest->error);
    message = nearest->integrator + " comes closest";
    // Including the margin that a choice leaves for the rest of the path.
    reachable = "at least " + rounded(2 * nearest->error);
  }
  if (nearest && answer.reference && answer.reference->uncertainty > tolerance) {
    const Reference& r = *answer.reference;
    detail = "errors as small as the tolerance cannot be resolved: " + r.method + " and " + r.checked_by +
             " differ by " + rounded(r.uncertainty) + " before the horizon";
    message = "two accurate methods differ by more than this";
    if (!(2 * nearest->error <= 1)) reachable = "a shorter horizon";
  }
  throw Error("accuracy_unreachable", detail,
              {"/accuracy/tolerance", "unreachable", message, write_json(tolerance), reachable, "", ""});
}

}  // namespace

AccuracyOutcome choose_method(const json::value& original, double budget, StudyContext& context) {
  const Scene scene = require_scene(read_scene(original));
  const AccuracyParams& wanted = scene.header.accuracy.value();
  const size_t system = studied_system(scene, wanted.system);
  const double dt = scene.header.time.dt;
  // Measured runs have no companion of their own.
  json::value document = original;
  document.as_object().erase("accuracy");
  const MethodQuestion question{
      .system = system,
      .quantity = quantity_of(wanted, build_world(document, context).system(system)),
      .tolerance = wanted.tolerance,
      .horizon = std::max(dt, wanted.horizon.value_or(scene.header.time.duration)),
      .budget = budget,
  };
  const MethodAnswer answer = search_method(document, question, context);

  constexpr const char* kJudges[] = {"path", "energy", "order"};
  JudgedBy judged_by = answer.judged_by;
  std::optional<MeasuredMethod> best = answer.best;
  // One that meets the tolerance with less margin is better than none.
  if (!best) {
    const MeasuredMethod* nearest = closest(answer.measured);
    if (nearest && nearest->error <= wanted.tolerance) best = *nearest;
  }
  if (!best && answer.out_of_time) {
    best = promised(document, system, wanted.tolerance, context);
    judged_by = JudgedBy::nothing;
  }
  if (!best) refuse(wanted.tolerance, answer);

  json::object report{{"tolerance", wanted.tolerance},
                      {"quantity", question.quantity},
                      {"horizon", question.horizon},
                      {"judged_by", kJudges[static_cast<size_t>(judged_by)]}};
  if (answer.reference) report["reference"] = describe_reference(*answer.reference);
  if (judged_by == JudgedBy::energy) {
    report["note"] =
        "two accurate methods differ by more than the tolerance before the horizon: the motion is chaotic or "
        "discontinuous, so single paths cannot be this accurate; methods are judged by energy drift";
  } else if (judged_by == JudgedBy::nothing) {
    report["note"] =
        "measuring would take longer than running the scene ten times: the method is chosen by its order, "
        "with a hundredth of the requested tolerance";
  } else if (answer.measured_horizon < question.horizon * (1 - 1e-9)) {
    report["note"] = "errors were measured over " + rounded(answer.measured_horizon) +
                     " s and extrapolated to the horizon";
    report["measured_horizon"] = answer.measured_horizon;
  }
  json::array runs;
  for (const MeasuredMethod& p : answer.measured) {
    if (std::isfinite(p.error)) runs.push_back(describe(p));
  }
  report["measured"] = std::move(runs);
  report["chosen"] = describe(*best);
  AccuracyOutcome out{original, std::move(report)};
  set_integrator(out.scene, system, best->integrator);
  if (is_adaptive(best->integrator))
    set_tolerance(out.scene, system, best->setting);
  else
    set_at(out.scene, "/time/substeps", static_cast<int64_t>(std::llround(dt / best->setting)));
  return out;
}

SettledScene settle_accuracy(const json::value& document, double budget, const ThreadArena& arena,
                             std::function<void(const Cost&)> admit) {
  SettledScene settled{require_scene(read_scene(document)), {}};
  if (!settled.scene.header.accuracy) return settled;
  const std::atomic<bool> never{false};
  StudyContext context{.arena = arena, .cancelled = never, .progress = [](double, const std::string&) {}};
  context.admit = std::move(admit);
  // On a busy machine, CPU time passes slowly.
  constexpr double kPatience = 3;
  context.deadline =
      std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                             std::chrono::duration<double>(kPatience * budget));
  AccuracyOutcome outcome = choose_method(document, budget, context);
  return {require_scene(read_scene(outcome.scene)), std::move(outcome.report)};
}

}  // namespace truestep
