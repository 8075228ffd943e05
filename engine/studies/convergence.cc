#include "engine/studies/convergence.h"

#include <algorithm>
#include <cmath>

#include "engine/core/equations/integrator.h"
#include "engine/integrators/table/integrators.h"
#include "engine/studies/precision/work_precision.h"
#include "engine/studies/scene_variant.h"

namespace truestep {

namespace json = boost::json;

ObservedOrder observed_order(const std::vector<double>& errors, double floor) {
  ObservedOrder out;
  std::vector<double> sound;  // orders of the finest consecutive halvings above the floor
  const double least = std::max(floor, 1e-14);
  for (size_t j = 0; j + 1 < errors.size(); ++j) {
    const double coarse = errors[j], fine = errors[j + 1];
    const bool usable = std::isfinite(coarse) && std::isfinite(fine) && fine > least && coarse > least;
    out.per_halving.push_back(usable ? std::log2(coarse / fine) : NAN);
    if (usable) {
      sound.push_back(out.per_halving.back());
    } else if (!(fine <= least)) {
      sound.clear();
    }
  }
  if (sound.size() < 3) {
    out.reason = "fewer than three halvings lie between instability and the uncertainty of the reference";
    return out;
  }
  double mean = 0;
  for (const double p : sound) mean += p / static_cast<double>(sound.size());
  out.mean = mean;
  const auto [least_p, greatest_p] = std::minmax_element(sound.end() - 3, sound.end());
  if (*greatest_p - *least_p >= 0.1) {
    out.reason = "the last three observed orders differ by " + std::to_string(*greatest_p - *least_p) +
                 ": not in the asymptotic range yet, or limited by discontinuities";
  } else {
    out.settled = sound.back();
  }
  return out;
}

const DefTable& convergence_table() {
  using P = ConvergenceParams;
  static const DefTable t =
      TableOf<P>("observed order of a method on this scene, or of a system in space")
          .text("system", &P::system, "system whose method is studied")
          .text("quantity", &P::quantity,
                "field whose error is measured; state: all coordinates of the system; expect, with refine: "
                "what the scene expects to equal a number at its end")
          .text("integrator", &P::integrator, "method; the scene's own when left out")
          .number("step", &P::step, "s", above(0), "largest step; 8 times the scene's when left out")
          .number("horizon", &P::horizon, "s", above(0),
                  "simulated time; else as much of the duration as the budget allows")
          .integer("halvings", &P::halvings, between(3, 20),
                   "most halvings of the step or the spacing; 7 in time, 4 in space and both")
          .choice("refine", &P::refine, refine_names(), kRefineSentence)
          .number("budget", &P::budget, "s", between(0.1, 1e5), "CPU time for the whole study")
          .build();
  return t;
}

namespace {

bool drawable(const WorkPoint& point) {
  return std::isfinite(point.error_end) && point.error_end > 0 && point.error_end < 10;
}

// An adaptive method chooses its steps: its errors follow its tolerances, and there is no order to observe.
StudyResult by_tolerance(const Integrator& method, const ConvergenceParams& p, const WorkMeasurement& m) {
  StudyResult r;
  r.table.columns = {
      {"tolerance", "1"}, {"steps", "1"}, {"error_end", "1"}, {"error_path", "1"}, {"status", ""}};
  r.plot = {.title = "Error of " + std::string(method.name) + " by its tolerance",
            .x_label = "tolerance",
            .y_label = "relative error of " + p.quantity};
  r.plot.series.push_back({.name = std::string(method.name)});
  for (const WorkPoint& point : m.points) {
    r.table.rows.push_back(
        {point.setting, static_cast<double>(point.steps), point.error_end, point.error_path, point.status});
    if (!drawable(point)) continue;
    r.plot.series[0].x.push_back(point.setting);
    r.plot.series[0].y.push_back(point.error_end);
  }
  r.summary = {{"integrator", std::string(method.name)},
               {"adaptive", true},
               {"promised_order", method.order},
               {"observed_order", nullptr},
               {"reason", "the method adapts its steps to its tolerance"},
               {"reference", describe_reference(m.reference)}};
  describe_reach(m, r.summary);
  return r;
}

}  // namespace

StudyResult run_convergence(const json::value& scene, const void* def, StudyContext& context) {
  const auto& p = *static_cast<const ConvergenceParams*>(def);
  if (p.refine != Refine::time) return run_refinement(scene, p, context);
  const Scene read = require_scene(read_scene(scene));
  const size_t system = studied_system(read, p.system);
  WorkPrecisionParams w;
  w.system = p.system, w.quantity = p.quantity, w.horizon = p.horizon, w.budget = p.budget, w.repeats = 1;
  const double horizon = p.horizon.value_or(read.header.time.duration);
  // Steps that divide the horizon: the largest one, then halved repeatedly.
  const double largest = p.step.value_or(8 * read.substep());
  w.samples = static_cast<int64_t>(std::clamp(std::floor(horizon / largest + 1e-9), 1.0, 1000.0));
  const double interval = horizon / static_cast<double>(w.samples);
  const double first = interval / std::max(1.0, std::round(interval / largest));
  for (int64_t k = 0; k <= p.halvings.value_or(7); ++k)
    w.steps.push_back(std::ldexp(first, static_cast<int>(-k)));
  w.integrators = {p.integrator};
  if (p.integrator.empty()) {
    const json::object canonical = read.canonical();
    const json::value* own = canonical.at("systems").at(system).as_object().if_contains("integrator");
    w.integrators = {own && own->is_string() && !own->as_string().empty()
                         ? std::string(own->as_string())
                         : std::string(read.systems[system].row->default_integrator)};
  }
  const WorkMeasurement m = measure_work(scene, w, context);
  const Integrator* row = find_integrator(w.integrators.front());
  if (row && row->stepping == Integrator::Stepping::adaptive) return by_tolerance(*row, p, m);
  std::vector<double> errors;
  for (const WorkPoint& point : m.points) errors.push_back(point.error_end);
  const ObservedOrder order = observed_order(errors, m.reference.floor());

  StudyResult r;
  r.table.columns = {
      {"step", "s"}, {"error_end", "1"}, {"error_path", "1"}, {"observed_order", "1"}, {"status", ""}};
  r.plot = {.title = "Convergence of " + w.integrators.front(),
            .x_label = "step in s",
            .y_label = "relative error of " + p.quantity};
  r.plot.series.push_back({.name = w.integrators.front()});
  for (size_t i = 0; i < m.points.size(); ++i) {
    const WorkPoint& point = m.points[i];
    StudyTable::Cell observed;
    if (i > 0 && std::isfinite(order.per_halving[i - 1])) observed = order.per_halving[i - 1];
    r.table.rows.push_back({point.setting, point.error_end, point.error_path, observed, point.status});
    if (drawable(point)) {
      r.plot.series[0].x.push_back(point.setting);
      r.plot.series[0].y.push_back(point.error_end);
    }
  }
  const auto& measured = r.plot.series[0];
  if (row && !measured.x.empty()) {
    // The promised slope through the finest point.
    StudyPlot::Series slope{.name = "order " + std::to_string(row->order),
                            .style = StudyPlot::Series::Style::dashed};
    for (const double h : {measured.x.front(), measured.x.back()}) {
      slope.x.push_back(h);
      slope.y.push_back(measured.y.back() * std::pow(h / measured.x.back(), row->order));
    }
    r.plot.series.push_back(std::move(slope));
  }
  r.summary = {{"integrator", w.integrators.front()},
               {"promised_order", row ? json::value(row->order) : json::value(nullptr)},
               {"observed_order", order.settled ? json::value(*order.settled) : json::value(nullptr)},
               {"reference", describe_reference(m.reference)}};
  if (!order.settled) r.summary["reason"] = order.reason;
  describe_reach(m, r.summary);
  return r;
}

}  // namespace truestep
