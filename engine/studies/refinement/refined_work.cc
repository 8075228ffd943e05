// Work against error with the resolution refined: every method's levels against one limit, which comes from
// semi-discrete solutions unless the scene knows it.
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/thread_clock.h"
#include "engine/integrators/table/integrators.h"
#include "engine/studies/precision/work_precision.h"
#include "engine/studies/refinement/refinement_study.h"

namespace truestep {

namespace json = boost::json;

WorkMeasurement measure_refined_work(const json::value& scene, const WorkPrecisionParams& p,
                                     StudyContext& context) {
  WorkMeasurement out;
  StudyContext quiet = context;  // progress is reported by method
  quiet.progress = [](double, const std::string&) {};
  ConvergenceParams c;
  c.system = p.system, c.quantity = p.quantity, c.horizon = p.horizon, c.halvings = p.halvings;
  c.refine = Refine::space, c.budget = 0.4 * p.budget;
  // What everything is measured against, from semi-discrete solutions, unless the scene knows it.
  RefinementStudy in_space(scene, c, quiet);
  std::vector<double> limit;
  if (!in_space.says_exact()) {
    in_space.run();
    LevelErrors found = judge_levels(in_space.common(), {}, 10 * in_space.time_uncertainty());
    out.reference.method = found.against;
    out.reference.uncertainty = in_space.time_uncertainty();
    limit = std::move(found.limit);
  } else {
    out.reference.method = in_space.expects() ? "what the scene expects" : "the scene's exact solution";
  }
  out.horizon = out.duration = in_space.horizon();
  std::vector<std::string> names = p.integrators;
  // What takes no integrator has one curve, by steps of its own.
  if (names.empty() && in_space.own_steps()) names.emplace_back();
  if (names.empty()) {
    for (const Integrator& row : integrators()) names.emplace_back(row.name);
  }
  const double started = thread_cpu_seconds(), whole = p.budget * (limit.empty() ? 1 : 0.6);
  c.refine = Refine::both;
  for (size_t i = 0; i < names.size(); ++i) {
    context.progress(static_cast<double>(i) / static_cast<double>(names.size()), names[i]);
    c.integrator = names[i];
    c.budget = (whole - (thread_cpu_seconds() - started)) / static_cast<double>(names.size() - i);
    if (c.budget <= 0) {
      out.refused.push_back({names[i], "the budget was used up before this run"});
      continue;
    }
    using Steps = RefinementStudy::Steps;
    try {
      RefinementStudy study(scene, c, quiet, p.refine == Refine::space ? Steps::keep : Steps::follow);
      study.run();
      for (size_t k = 0; k < study.levels().size(); ++k) {
        const RefinementStudy::Level& l = study.levels()[k];
        WorkPoint point{.integrator = names[i].empty() ? in_space.subject() : names[i],
                        .setting = l.setting,
                        .cpu_seconds = l.cpu_seconds};
        point.refined = l.refined, point.status = l.status;
        const double e = limit.empty() ? study.exact()[k] : relative_error(study.common()[k], limit);
        point.error_end = point.error_path = l.status == "ok" ? e : INFINITY;
        out.points.push_back(std::move(point));
      }
    } catch (const Error& e) {
      if (e.code() == "cancelled") throw;
      out.refused.push_back({names[i], e.issues().empty() ? e.what() : e.issues().front().message});
    }
  }
  return out;
}

}  // namespace truestep
