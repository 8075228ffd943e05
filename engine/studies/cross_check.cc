#include "engine/studies/cross_check.h"

#include <cmath>

#include "engine/base/errors.h"
#include "engine/studies/scene_variant.h"
#include "engine/studies/trajectory.h"

namespace truestep {

namespace json = boost::json;

namespace {

const DefTable& side_table() {
  using S = CrossCheckSide;
  static const DefTable t =
      TableOf<S>("one of the two ways; what is left out stays as the scene has it")
          .text("integrator", &S::integrator, "method")
          .number("dt", &S::dt, "s", above(0), "step")
          .number("tolerance", &S::tolerance, "1", above(0), "tolerance of an adaptive method")
          .text("engine", &S::engine, "another engine behind the same scene, where the system has one")
          .build();
  return t;
}

struct Run {
  Trace trace;
  double dt = 0;
};

Run run_side(const json::value& scene, const CrossCheckSide& side, TraceRequest request, double interval,
             double scene_dt, const char* name, const StudyContext& context) {
  json::value d = scene;
  const double wanted = side.dt.value_or(scene_dt);
  request.steps_per_sample = std::max<uint64_t>(1, static_cast<uint64_t>(std::llround(interval / wanted)));
  Run r;
  r.dt = interval / static_cast<double>(request.steps_per_sample);
  set_dt(d, r.dt);
  if (!side.integrator.empty()) set_integrator(d, request.field.system, side.integrator);
  if (side.tolerance) set_tolerance(d, request.field.system, *side.tolerance);
  if (!side.engine.empty())
    set_at(d, "/systems/" + std::to_string(request.field.system) + "/engine", json::string(side.engine));
  try {
    r.trace = trace(build_world(d), request, context);
  } catch (const Error& e) {
    if (e.code() != "scene_invalid") throw;
    auto issues = e.issues();
    for (Issue& i : issues) i.pointer = std::string("/") + name + " -> scene" + i.pointer;
    throw Error("scene_invalid", e.what(), std::move(issues));
  }
  return r;
}

// Slope of log(difference) over t where it lies between rounding and saturation; nothing with fewer than 5
// points.
std::optional<double> growth_rate(const std::vector<double>& t, const std::vector<double>& d) {
  double n = 0, st = 0, sl = 0, stt = 0, stl = 0;
  for (size_t i = 0; i < t.size(); ++i) {
    if (!(d[i] > 1e-14 && d[i] < 1e-1)) continue;
    const double l = std::log(d[i]);
    n += 1, st += t[i], sl += l, stt += t[i] * t[i], stl += t[i] * l;
  }
  const double spread = n * stt - st * st;
  if (n < 5 || !(spread > 0)) return std::nullopt;
  return (n * stl - st * sl) / spread;
}

}  // namespace

const DefTable& cross_check_table() {
  using P = CrossCheckParams;
  static const DefTable t =
      TableOf<P>("how far two ways of computing this scene part over time")
          .text("system", &P::system, "system that is compared")
          .text("quantity", &P::quantity, "field that is compared; state: all that says where the system is")
          .object("a", &P::a, side_table(), "one way")
          .object("b", &P::b, side_table(), "the other")
          .number("horizon", &P::horizon, "s", above(0), "simulated time; the scene's duration when left out")
          .integer("samples", &P::samples, between(2, 10000), "instants of comparison")
          .number("budget", &P::budget, "s", between(0.1, 1e5), "CPU time for the whole study")
          .build();
  return t;
}

StudyResult run_cross_check(const json::value& scene, const void* def, StudyContext& context) {
  const auto& p = *static_cast<const CrossCheckParams*>(def);
  const Scene read = require_scene(read_scene(scene));
  TraceRequest request;
  request.field = {studied_system(read, p.system), p.quantity};
  request.samples = static_cast<size_t>(p.samples);
  request.cpu_limit = p.budget / 2;
  const double interval = p.horizon.value_or(read.header.time.duration) / static_cast<double>(p.samples);
  context.progress(0, "a");
  const Run a = run_side(scene, p.a, request, interval, read.substep(), "a", context);
  context.progress(0.5, "b");
  const Run b = run_side(scene, p.b, request, interval, read.substep(), "b", context);

  StudyResult r;
  r.table.columns = {{"time", "s"}, {"difference", "1"}};
  StudyPlot::Series s{.name = "a against b", .style = StudyPlot::Series::Style::line};
  std::vector<double> times, differences;
  const size_t both = std::min(a.trace.values.size(), b.trace.values.size());
  for (size_t i = 0; i < both; ++i) {
    const double d = relative_error(a.trace.values[i], b.trace.values[i]);
    times.push_back(a.trace.times[i]);
    differences.push_back(d);
    r.table.rows.push_back({a.trace.times[i], d});
    if (d > 0 && std::isfinite(d)) s.x.push_back(a.trace.times[i]), s.y.push_back(d);
  }
  const auto side = [](const Run& run) {
    json::object o{{"dt", run.dt},
                   {"steps", run.trace.steps},
                   {"cpu_seconds", run.trace.cpu_seconds},
                   {"complete", run.trace.end == Trace::End::complete}};
    if (!run.trace.detail.empty()) o["detail"] = run.trace.detail;
    return o;
  };
  r.summary = {{"a", side(a)}, {"b", side(b)}, {"growth_rate", nullptr}};
  if (both > 0 && std::isfinite(differences.back())) r.summary["difference_at_end"] = differences.back();
  if (const auto rate = growth_rate(times, differences)) r.summary["growth_rate"] = *rate;
  r.plot = {.title = "Two ways of computing one scene",
            .x_label = "time in s",
            .y_label = "relative difference of " + p.quantity,
            .x_scale = StudyPlot::Scale::linear,
            .series = {std::move(s)}};
  return r;
}

}  // namespace truestep
