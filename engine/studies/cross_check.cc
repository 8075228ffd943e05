#include "engine/studies/cross_check.h"

#include <cmath>

#include "engine/base/errors.h"
#include "engine/studies/pose_difference.h"
#include "engine/studies/scene_variant.h"
#include "engine/studies/trajectory.h"

namespace truestep {

namespace json = boost::json;

namespace {

const DefTable& side_table() {
  using S = CrossCheckSide;
  static const DefTable t =
      TableOf<S>("one of the two computations; what is left out is as in the scene")
          .text("integrator", &S::integrator, "method")
          .number("dt", &S::dt, "s", above(0), "step")
          .number("tolerance", &S::tolerance, "1", above(0), "tolerance of an adaptive method")
          .text("engine", &S::engine,
                "whose solver steps the scene: truestep, bullet (rigid3d), box2d (rigid2d)")
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
    r.trace = trace(build_world(d, context), request, context);
  } catch (const Error& e) {
    if (e.code() != "scene_invalid") throw;
    auto issues = e.issues();
    for (Issue& i : issues) i.pointer = std::string("/") + name + " -> scene" + i.pointer;
    throw Error("scene_invalid", e.what(), std::move(issues));
  }
  return r;
}

// Slope of log(difference) over t between rounding and saturation; empty with fewer than 5 points.
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
      TableOf<P>("difference between two computations of this scene over time")
          .text("system", &P::system, "system to compare")
          .text("quantity", &P::quantity, "field to compare; state: all coordinates of the system")
          .object("a", &P::a, side_table(), "one computation")
          .object("b", &P::b, side_table(),
                  "the other computation; default for rigid bodies: the other engine")
          .texts("statistics", &P::statistics, {0, 32},
                 "observables of the system to compare; default for rigid bodies: energies, penetration of "
                 "bodies and gaps of joints")
          .number("horizon", &P::horizon, "s", above(0), "simulated time; the scene's duration when left out")
          .integer("samples", &P::samples, between(2, 10000), "number of instants compared")
          .number("budget", &P::budget, "s", between(0.1, 1e5), "CPU time for the whole study")
          .build();
  return t;
}

namespace {

/// The system to compare: the named one, or the first for which a method or an engine can be chosen.
size_t compared_system(const Scene& scene, const std::string& id) {
  std::string ids;
  for (size_t i = 0; i < scene.systems.size(); ++i) {
    const SceneSystem& s = scene.systems[i];
    if (!s.row->table->find("integrator") && !s.row->table->find("engine")) continue;
    if (id.empty() || s.id == id) return i;
    ids += (ids.empty() ? "" : ", ") + s.id;
  }
  throw Error("scene_invalid", "no system of the scene fits the study",
              {"/system", "unknown_system", "the study needs a system with an integrator or engines",
               '"' + id.substr(0, 64) + '"', ids, "", ""});
}

bool says_nothing(const CrossCheckSide& s) {
  return s.integrator.empty() && s.engine.empty() && !s.dt && !s.tolerance;
}

/// The engine that the scene does not use, if the system has a choice.
std::string other_engine(const json::value& scene, const Scene& read, size_t system) {
  const ParamRow* row = read.systems[system].row->table->find("engine");
  if (!row || row->choices.size() < 2) return "";
  const json::object& o = scene.at("systems").at(system).as_object();
  const json::value* now = o.if_contains("engine");
  const bool own = !now || !now->is_string() || now->as_string() == row->choices[0];
  return row->choices[own ? 1 : 0];
}

/// What is compared besides the poses.
std::vector<std::string> statistics(const CrossCheckParams& p, const System& system, RigidKind kind) {
  Observables now;
  system.observe(system.initial_state(), 0, now);
  std::vector<std::string> out;
  if (p.statistics.empty() && kind != RigidKind::none) {
    for (const char* name :
         {"energy.kinetic", "energy.potential", "energy.total", "penetration", "joints.gap"}) {
      if (now.find(name)) out.push_back(name);
    }
  }
  std::string names;
  for (const Observation& o : now.rows()) names += (names.empty() ? "" : ", ") + o.name;
  for (size_t i = 0; i < p.statistics.size(); ++i) {
    if (!now.find(p.statistics[i]))
      throw Error("scene_invalid", "the system has no such observable",
                  {"/statistics/" + std::to_string(i), "unknown_observable",
                   "the system has no such observable", '"' + p.statistics[i] + '"', names, "", ""});
    out.push_back(p.statistics[i]);
  }
  return out;
}

/// Means over the samples, final values and the largest difference of every statistic.
json::object compare_statistics(const std::vector<std::string>& names, const Trace& a, const Trace& b) {
  json::object out;
  const size_t n = std::min(a.observed.size(), b.observed.size());
  const auto number = [](double x) { return std::isfinite(x) ? json::value(x) : json::value(nullptr); };
  for (size_t k = 0; k < names.size() && n > 0; ++k) {
    double mean_a = 0, mean_b = 0, most = 0;
    for (size_t i = 0; i < n; ++i) {
      mean_a += a.observed[i][k] / static_cast<double>(n),
          mean_b += b.observed[i][k] / static_cast<double>(n);
      most = std::max(most, std::abs(a.observed[i][k] - b.observed[i][k]));
    }
    out[names[k]] = {{"a", {{"mean", number(mean_a)}, {"end", number(a.observed[n - 1][k])}}},
                     {"b", {{"mean", number(mean_b)}, {"end", number(b.observed[n - 1][k])}}},
                     {"largest_difference", number(most)}};
  }
  return out;
}

}  // namespace

StudyResult run_cross_check(const json::value& scene, const void* def, StudyContext& context) {
  const auto& p = *static_cast<const CrossCheckParams*>(def);
  const Scene read = require_scene(read_scene(scene));
  TraceRequest request;
  const size_t system = compared_system(read, p.system);
  request.field = {system, p.quantity};
  CrossCheckSide side_b = p.b;
  if (says_nothing(p.a) && says_nothing(p.b)) side_b.engine = other_engine(scene, read, system);
  const World world = build_world(scene, context);
  const RigidKind kind = rigid_kind(world.system(system).initial_state());
  const bool poses = kind != RigidKind::none && p.quantity == "state";
  request.observables = statistics(p, world.system(system), kind);
  request.samples = static_cast<size_t>(p.samples);
  request.cpu_limit = p.budget / 2;
  const double interval = p.horizon.value_or(read.header.time.duration) / static_cast<double>(p.samples);
  context.progress(0, "a");
  const Run a = run_side(scene, p.a, request, interval, read.substep(), "a", context);
  context.progress(0.5, "b");
  const Run b = run_side(scene, side_b, request, interval, read.substep(), "b", context);

  StudyResult r;
  r.table.columns = {{"time", "s"}, {"difference", "1"}};
  if (poses) {
    for (const char* name : {"position_rms", "position_largest"}) r.table.columns.push_back({name, "m"});
    for (const char* name : {"angle_rms", "angle_largest"}) r.table.columns.push_back({name, "rad"});
  }
  for (const std::string& name : request.observables) {
    for (const char* which : {"a: ", "b: "}) r.table.columns.push_back({which + name, "SI"});
  }
  PoseDifference largest, last;
  StudyPlot::Series s{.name = "a against b", .style = StudyPlot::Series::Style::line};
  std::vector<double> times, differences;
  const size_t both = std::min(a.trace.values.size(), b.trace.values.size());
  for (size_t i = 0; i < both; ++i) {
    const double d = relative_error(a.trace.values[i], b.trace.values[i]);
    times.push_back(a.trace.times[i]);
    differences.push_back(d);
    auto& row = r.table.rows.emplace_back();
    row = {a.trace.times[i], d};
    if (poses) {
      last = pose_difference(kind, a.trace.values, b.trace.values, i);
      largest.take_larger(last);
      for (const double x : {last.position_rms, last.position_largest, last.angle_rms, last.angle_largest})
        row.push_back(x);
    }
    for (size_t k = 0; k < request.observables.size(); ++k) {
      row.push_back(a.trace.observed[i][k]), row.push_back(b.trace.observed[i][k]);
    }
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
  if (!side_b.engine.empty()) r.summary["b"].as_object()["engine"] = side_b.engine;
  if (poses) r.summary["poses"] = {{"largest", describe(largest)}, {"at_end", describe(last)}};
  if (!request.observables.empty())
    r.summary["statistics"] = compare_statistics(request.observables, a.trace, b.trace);
  if (both > 0 && std::isfinite(differences.back())) r.summary["difference_at_end"] = differences.back();
  if (const auto rate = growth_rate(times, differences)) r.summary["growth_rate"] = *rate;
  r.plot = {.title = "Two computations of one scene",
            .x_label = "time in s",
            .y_label = "relative difference of " + p.quantity,
            .x_scale = StudyPlot::Scale::linear,
            .series = {std::move(s)}};
  return r;
}

}  // namespace truestep
