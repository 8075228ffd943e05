// What a convergence study over resolution reports: a row per level, the order its errors settle to, and a
// plot with the slope that was promised.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/studies/refinement/refinement_study.h"

namespace truestep {

namespace json = boost::json;

StudyResult RefinementStudy::result() const {
  const bool both = p_.refine == Refine::both;
  LevelErrors found = judge_levels(common_, exact_, 10 * uncertainty_);
  if (expects()) found.against = "what the scene expects";
  const int promised = both ? promised_ : order_;
  StudyResult r;
  r.table.columns = {
      {"refined", "1"},     {"rows", "1"},      {adaptive_ ? "tolerance" : "step", adaptive_ ? "1" : "s"},
      {"cpu_seconds", "s"}, {"error_end", "1"}, {"observed_order", "1"},
      {"status", ""}};
  r.plot = {.title = "Convergence of " + ladder_.subject(),
            .x_label = "spacing, 1 = the scene's own",
            .y_label = "relative error of " + (expects() ? "what is expected" : request_.field.name)};
  r.plot.series.push_back({.name = both && method_ ? std::string(method_->name) : ladder_.subject()});
  auto& measured = r.plot.series[0];
  for (size_t k = 0; k < levels_.size(); ++k) {
    const Level& l = levels_[k];
    StudyTable::Cell observed, setting;
    if (k > 0 && std::isfinite(found.per_level[k - 1])) observed = found.per_level[k - 1];
    if (both) setting = l.setting;
    r.table.rows.push_back({l.refined, static_cast<double>(l.rows), setting, l.cpu_seconds, found.errors[k],
                            observed, l.status});
    if (!(found.errors[k] > 0 && found.errors[k] < 10)) continue;
    measured.x.push_back(1 / l.refined), measured.y.push_back(found.errors[k]);
  }
  if (promised > 0 && !measured.x.empty()) {
    StudyPlot::Series slope{.name = "order " + std::to_string(promised),
                            .style = StudyPlot::Series::Style::dashed};
    for (const double x : {measured.x.front(), measured.x.back()}) {
      slope.x.push_back(x);
      slope.y.push_back(measured.y.back() * std::pow(x / measured.x.back(), promised));
    }
    r.plot.series.push_back(std::move(slope));
  }
  const auto known = [](bool is, auto v) { return is ? json::value(v) : json::value(nullptr); };
  r.summary = {{"refine", refine_names()[static_cast<size_t>(p_.refine)]},
               {"subject", ladder_.subject()},
               {"integrator", both && method_ ? json::value(method_->name) : json::value(nullptr)},
               {"promised_order", known(promised > 0, promised)},
               {"observed_order", known(found.settled.has_value(), found.settled.value_or(0))},
               {"measured_against", found.against},
               {"horizon", horizon_}};
  if (both && !adaptive_) r.summary["step_follows"] = power_ == 1 ? "dx" : "dx^" + std::to_string(power_);
  if (!both) r.summary["in_time"] = json::object{{"method", methods_}, {"uncertainty", uncertainty_}};
  if (!found.settled) {
    r.summary["reason"] = found.reason;
    // The position of a front between the cells changes from one grid to the next, and the orders with it.
    if (found.mean) r.summary["mean_order"] = *found.mean;
  }
  if (!note_.empty()) r.summary["note"] = note_;
  return r;
}

StudyResult run_refinement(const json::value& scene, const ConvergenceParams& p, StudyContext& context) {
  for (const auto& [given, pointer] :
       {std::pair{!p.integrator.empty(), "/integrator"}, {p.step.has_value(), "/step"}}) {
    if (p.refine != Refine::space || !given) continue;
    const char* why = "refinement in space uses methods and steps whose errors are negligible";
    throw Error("scene_invalid", why, {pointer, "inconsistent", why, "", "\"refine\": \"both\"", "", ""});
  }
  RefinementStudy study(scene, p, context);
  study.run();
  return study.result();
}

}  // namespace truestep
