#include "engine/studies/stability.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/integrators/control/spectrum.h"
#include "engine/integrators/table/integrators.h"
#include "engine/studies/border_search.h"
#include "engine/studies/scene_variant.h"
#include "engine/studies/trajectory.h"

namespace truestep {

namespace json = boost::json;

namespace {

std::vector<const Integrator*> methods(const StabilityParams& p, const ForceField& field) {
  std::vector<const Integrator*> out;
  for (const Integrator& row : integrators()) {
    if (!p.integrators.empty()) {
      if (std::find(p.integrators.begin(), p.integrators.end(), row.name) != p.integrators.end())
        out.push_back(&row);
    } else if (row.stepping == Integrator::Stepping::fixed && row.kind == Integrator::Kind::explicit_ &&
               !refusal(row, field)) {
      out.push_back(&row);
    }
  }
  if (out.empty() || (!p.integrators.empty() && out.size() < p.integrators.size())) {
    std::string all;
    for (const Integrator& row : integrators()) all += (all.empty() ? "" : ", ") + std::string(row.name);
    throw Error("scene_invalid", "an integrator of the study does not exist",
                {"/integrators", "unknown_choice", "there is no such integrator", "", all, "", ""});
  }
  return out;
}

}  // namespace

const DefTable& stability_table() {
  using P = StabilityParams;
  static const DefTable t =
      TableOf<P>("largest stable step of each method, measured and from theory")
          .text("system", &P::system, "system whose method varies; the first that has one when left out")
          .texts("integrators", &P::integrators, {0, 64},
                 "methods; the explicit fixed-step ones when left out")
          .integer("steps", &P::steps, between(10, 1e7), "steps that a run must survive")
          .number("accuracy", &P::accuracy, "1", between(1e-9, 0.5),
                  "relative width at which the bisection of a limit ends")
          .number("budget", &P::budget, "s", between(0.1, 1e5), "CPU time for the whole study")
          .build();
  return t;
}

StudyResult run_stability(const json::value& scene, const void* def, StudyContext& context) {
  const auto& p = *static_cast<const StabilityParams*>(def);
  const Scene read = require_scene(read_scene(scene));
  const size_t system = studied_system(read, p.system);
  const World world = build_world(scene, context);
  const Integration own = world.system(system).integration();
  if (!own.field) {
    throw Error(
        "scene_invalid", "the system has no force field",
        {"/system", "wrong_system", "stability needs a system of forces", '"' + p.system + '"', "", "", ""});
  }
  const WorldState start = world.initial_state();
  const Spectrum spectrum = estimate_spectrum(*own.field, start.systems[system], 0);

  if (spectrum.omega == 0 && spectrum.damping == 0) {
    throw Error("study_failed", "the system's forces neither oscillate nor decay: no step is unstable",
                {"/system", "no_rates", "the linearised forces have no frequency and no damping rate",
                 '"' + read.systems[system].id + '"', "", "", ""});
  }

  StudyResult r;
  r.table.columns = {{"integrator", ""}, {"largest_stable_dt", "s"}, {"theory_dt", "s"}, {"ratio", "1"},
                     {"status", ""},     {"stable_again", ""}};
  const auto rows = methods(p, *own.field);
  using Style = StudyPlot::Series::Style;
  StudyPlot::Series measured{.name = "measured", .style = Style::markers},
      theory{.name = "linear theory", .style = Style::rings},
      again{.name = "stable again, first and last step", .style = Style::rings};
  std::vector<std::string> names;
  int64_t fewest = p.steps;
  double resolution = 0;
  json::object windows;
  for (size_t i = 0; i < rows.size(); ++i) {
    const Integrator& row = *rows[i];
    context.progress(static_cast<double>(i) / static_cast<double>(rows.size()), std::string(row.name));
    // The scene's options are kept while its method changes.
    const double limit = stability_interval(row, *own.options).largest_step(spectrum.omega, spectrum.damping);
    const double guess = std::isfinite(limit) && limit > 0 ? limit
                         : spectrum.omega > 0              ? 1 / spectrum.omega
                                                           : world.scene().substep();
    StudyTable::Cell dt, promised, ratio;
    std::string status, spans;
    try {
      BorderSearch search(scene, p, system, std::string(row.name), context);
      const auto f = search.find(guess, p.budget / static_cast<double>(rows.size()));
      fewest = std::min(fewest, search.steps());
      resolution = std::max(resolution, search.resolution());
      using Kind = decltype(f.kind);
      const std::string up_to = "no limit found up to " + short_number(f.dt, 3) + " s";
      // Linear theory knows of no stable step: what is measured is slow growth.
      const bool grows = limit == 0 && f.kind == Kind::limit;
      status = grows ? "unstable at every step by theory; less than tenfold in " +
                           std::to_string(search.steps()) + " steps up to " + short_number(f.dt, 3) + " s"
               : f.kind == Kind::limit  ? "ok"
               : f.kind == Kind::always ? "stable at every step tried: " + up_to
               : f.kind == Kind::never  ? "unstable at every step tried"
                                        : "over budget: " + up_to;
      if (search.unsolved()) status += "; not all equations of its steps were solved";
      if (f.kind == Kind::limit && !grows) dt = f.dt;
      if (std::isfinite(limit)) promised = limit;
      if (f.kind == Kind::limit && !grows) {
        const auto y = static_cast<double>(names.size());
        names.emplace_back(row.name);
        measured.x.push_back(f.dt), measured.y.push_back(y);
        json::array list;
        for (const auto& span : f.again) {
          again.x.insert(again.x.end(), {span.from, span.to}), again.y.insert(again.y.end(), {y, y});
          list.push_back({{"from", span.from}, {"to", span.to}});
          spans += (spans.empty() ? "" : ", ") + short_number(span.from, 4) + " to " +
                   short_number(span.to, 4) + " s";
        }
        if (!list.empty()) windows[row.name] = std::move(list);
        if (std::isfinite(limit) && limit > 0) {
          ratio = f.dt / limit;
          theory.x.push_back(limit), theory.y.push_back(y);
        }
      }
    } catch (const Error& e) {
      if (e.code() != "scene_invalid") throw;
      status = e.issues().empty() ? e.what() : e.issues().front().message;
    }
    r.table.rows.push_back({std::string(row.name), dt, promised, ratio, status,
                            spans.empty() ? StudyTable::Cell{} : StudyTable::Cell{spans}});
  }
  r.summary = {{"omega_max", spectrum.omega},
               {"damping_max", spectrum.damping},
               {"iterations", spectrum.iterations},
               {"suggested_dt", nullptr},
               {"resolution", resolution}};
  if (!windows.empty()) r.summary["stable_again"] = std::move(windows);
  if (fewest < p.steps) {
    r.summary["note"] = "the budget reaches runs of " + std::to_string(fewest) + " of the " +
                        std::to_string(p.steps) + " steps; give a larger budget or fewer integrators";
  }
  if (const auto dt = world.system(system).limit(Limit::stable_dt, start.systems[system], 0))
    r.summary["suggested_dt_bound"] = *dt;
  const double suggested =
      stability_interval(*own.method, *own.options).largest_step(spectrum.omega, spectrum.damping);
  // A tenth below the limit: the spectrum is that of the start.
  if (std::isfinite(suggested) && suggested > 0) r.summary["suggested_dt"] = 0.9 * suggested;
  r.plot = {.title = "Largest stable step",
            .x_label = "dt in s",
            .y_label = "",
            .y_names = std::move(names),
            .series = {std::move(theory), std::move(measured)}};
  if (!again.x.empty()) r.plot.series.push_back(std::move(again));
  return r;
}

}  // namespace truestep
