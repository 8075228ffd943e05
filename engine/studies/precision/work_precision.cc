#include "engine/studies/precision/work_precision.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/core/equations/integrator.h"
#include "engine/integrators/table/integrators.h"
#include "engine/studies/scene_variant.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr double kShortRun = 0.005;  // s
constexpr int64_t kMostRepeats = 25;
constexpr double kProbe = 0.02;      // share of the budget for finding out how fast the scene steps
constexpr double kFewestSteps = 16;  // fewest steps of the scene that a study covers
constexpr double kMargin = 0.3;      // fraction of what one run reached: a reference takes several
constexpr std::array kDecades = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12};

// How often an interval between samples is divided: a ladder around the scene's own step, or as requested.
std::vector<uint64_t> divisions(const WorkPrecisionParams& p, double interval, double scene_dt) {
  std::vector<uint64_t> m;
  const auto add = [&](double dt) {
    m.push_back(std::max<uint64_t>(1, static_cast<uint64_t>(std::llround(interval / dt))));
  };
  if (!p.steps.empty()) {
    for (const double dt : p.steps) add(dt);
  } else {
    for (int k = 3; k >= -7; --k) add(std::ldexp(scene_dt, k));
  }
  std::sort(m.begin(), m.end());
  m.erase(std::unique(m.begin(), m.end()), m.end());
  return m;
}

std::vector<double> tolerances(const WorkPrecisionParams& p) {
  if (!p.tolerances.empty()) return p.tolerances;
  return {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12};
}

std::vector<std::string> methods(const WorkPrecisionParams& p) {
  if (!p.integrators.empty()) return p.integrators;
  std::vector<std::string> all;
  for (const Integrator& row : integrators()) all.emplace_back(row.name);
  return all;
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + static_cast<long>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

class Measurer {
 public:
  Measurer(const json::value& scene, const WorkPrecisionParams& p, StudyContext& context)
      : scene_(scene), params_(p), context_(context) {
    const Scene s = require_scene(read_scene(scene));
    request_.field = {studied_system(s, p.system), p.quantity};
    request_.observables = {"integrator.steps"};
    scene_dt_ = s.substep();
    session_dt_ = s.header.time.dt;
    out_.duration = p.horizon.value_or(s.header.time.duration);
    cover(out_.duration);
  }

  WorkMeasurement run() {
    context_.progress(0, "reference");
    const double started = thread_cpu_seconds();
    const auto names = methods(params_);
    out_.steps_matter = steps_matter(build_world(scene_, context_));
    if (!params_.horizon) cover(affordable(names.size()));
    find_reference_or_shorten();
    for (size_t i = 0; i < names.size(); ++i) {
      context_.progress(0.3 + 0.7 * static_cast<double>(i) / static_cast<double>(names.size()), names[i]);
      const double left = params_.budget - (thread_cpu_seconds() - started);
      if (left > 0) {
        measure(names[i], std::max(0.05, left / static_cast<double>(names.size() - i)));
      } else {
        out_.refused.push_back({names[i], "the budget was used up before this run"});
      }
    }
    return std::move(out_);
  }

 private:
  // Samples and steps for a horizon; a shortened one is a whole number of the largest steps.
  void cover(double horizon) {
    size_t samples = static_cast<size_t>(params_.samples);
    if (horizon < out_.duration) {
      const double largest = params_.steps.empty()
                                 ? 8 * scene_dt_
                                 : *std::max_element(params_.steps.begin(), params_.steps.end());
      const double unit = largest <= horizon ? largest : scene_dt_;
      const double units = std::max(1.0, std::floor(horizon / unit + 1e-9));
      samples = std::min(samples, static_cast<size_t>(units));
      horizon = std::floor(units / static_cast<double>(samples)) * static_cast<double>(samples) * unit;
    }
    out_.horizon = horizon;
    request_.samples = samples;
    interval_ = horizon / static_cast<double>(samples);
    divisions_ = divisions(params_, interval_, scene_dt_);
    request_.steps_per_sample =
        std::max<uint64_t>(1, static_cast<uint64_t>(std::llround(interval_ / scene_dt_)));
  }

  // How far every method gets at a quarter of the scene's step, if it is as fast as the scene's own; at least
  // kFewestSteps.
  double affordable(size_t methods) const {
    TraceRequest probe = request_;
    probe.cpu_limit = kProbe * params_.budget;
    json::value d = scene_;
    set_dt(d, scene_dt_);
    const Trace own = trace(build_world(d, context_), probe, context_);
    if (own.end != Trace::End::over_budget) return out_.duration;
    const double per_step = own.cpu_seconds / static_cast<double>(own.steps);
    const double share = 0.5 * params_.budget / static_cast<double>(methods);
    return scene_dt_ * std::max(kFewestSteps, share / (4 * per_step));
  }

  void find_reference_or_shorten() {
    for (double share = 0.3 * params_.budget;; share *= 0.5) {
      ReferenceSearch found = find_reference(scene_, request_, interval_, share, context_);
      if (found.reference) {
        out_.reference = std::move(*found.reference);
        return;
      }
      const double possible = kMargin * found.reached * out_.horizon;
      if (params_.horizon || possible < scene_dt_ || share < 0.02 * params_.budget) refuse(possible);
      cover(possible);
    }
  }

  [[noreturn]] void refuse(double possible) const {
    const std::string allowed =
        possible >= scene_dt_ ? "about " + short_number(possible, 3) + " s at most" : "a larger budget";
    throw Error(
        "study_failed", "no method completes a reference solution within the time budget",
        {"/horizon", "too_long", "no method gets this far in time and is accurate enough to be a reference",
         short_number(out_.horizon, 3), allowed, "", "s"});
  }

  void measure(const std::string& name, double share) {
    const Integrator* row = find_integrator(name);
    if (!row) {
      std::string all;
      for (const Integrator& r : integrators()) all += (all.empty() ? "" : ", ") + std::string(r.name);
      throw Error(
          "scene_invalid", "there is no integrator \"" + name + '"',
          {"/integrators", "unknown_choice", "there is no such integrator", '"' + name + '"', all, "", ""});
    }
    const bool adaptive = row->stepping == Integrator::Stepping::adaptive;
    // From cheap to expensive, so that a budget which runs out cuts off the end of the curve.
    double spent = 0, last = 0;
    if (adaptive) {
      // Steps that do more than integrate stay the scene's own, or the runs would solve another problem. With
      // a shortened horizon, the clock is also checked more often.
      const bool own = out_.steps_matter || out_.horizon < out_.duration;
      const double wanted = params_.adaptive_step.value_or(own ? session_dt_ : interval_);
      request_.steps_per_sample =
          std::max<uint64_t>(1, static_cast<uint64_t>(std::llround(interval_ / wanted)));
      const double dt = interval_ / static_cast<double>(request_.steps_per_sample);
      for (const double tolerance : tolerances(params_)) {
        if (!one(name, tolerance, dt, share, spent, last)) return;
      }
    } else {
      for (const uint64_t m : divisions_) {
        request_.steps_per_sample = m;
        const double dt = interval_ / static_cast<double>(m);
        if (!one(name, dt, dt, share, spent, last)) return;
      }
    }
  }

  // Returns false to end this method's curve.
  bool one(const std::string& name, double setting, double dt, double share, double& spent, double& last) {
    const bool adaptive = find_integrator(name)->stepping == Integrator::Stepping::adaptive;
    WorkPoint p{.integrator = name, .setting = setting};
    if (spent + 2 * last > share) {
      p.status = "over budget";
      p.cpu_seconds = p.error_end = p.error_path = NAN;
      out_.points.push_back(p);
      return false;
    }
    json::value d = scene_;
    set_dt(d, dt);
    set_integrator(d, request_.field.system, name);
    if (adaptive) set_tolerance(d, request_.field.system, setting);
    std::vector<double> times;
    request_.cpu_limit = share - spent;
    try {
      const World world = build_world(d, context_);
      Trace t;
      // Short runs are repeated more often: the clock's own noise is a few microseconds.
      double total = 0;
      for (int64_t r = 0; r < params_.repeats || (total < kShortRun && r < kMostRepeats); ++r) {
        t = trace(world, request_, context_);
        spent += t.cpu_seconds, total += t.cpu_seconds;
        times.push_back(t.cpu_seconds);
        if (t.end != Trace::End::complete || spent + t.cpu_seconds > share) break;
      }
      // Adaptive methods take their own steps within those of the session.
      const double own = t.observed.empty() ? NAN : t.observed.back().front();
      p.steps = adaptive && own > 0 ? static_cast<uint64_t>(own) : t.steps;
      p.cpu_seconds = last = median(times);
      judge(t, p);
    } catch (const Error& e) {
      if (e.code() == "cancelled") throw;
      out_.refused.push_back({name, e.issues().empty() ? e.what() : e.issues().front().message});
      return false;
    }
    out_.points.push_back(p);
    // Finer than the reference shows nothing new.
    return p.status != "over budget" && p.status != "at the floor";
  }

  void judge(const Trace& t, WorkPoint& p) const {
    if (t.end != Trace::End::complete) {
      p.status = t.end == Trace::End::unstable ? "unstable" : "over budget";
      p.error_end = p.error_path = INFINITY;
      return;
    }
    const Trace& r = out_.reference.trace;
    const double least = rounding_size(r.values);
    for (size_t i = 0; i < r.values.size(); ++i)
      p.error_path = std::max(p.error_path, relative_error(t.values[i], r.values[i], least));
    p.error_end = relative_error(t.values.back(), r.values.back(), least);
    p.status = p.error_path < out_.reference.floor() ? "at the floor" : "ok";
  }

  const json::value& scene_;
  const WorkPrecisionParams& params_;
  StudyContext& context_;
  TraceRequest request_;
  double scene_dt_ = 0, session_dt_ = 0, interval_ = 0;
  std::vector<uint64_t> divisions_;
  WorkMeasurement out_;
};

json::array cheapest(const WorkMeasurement& m) {
  json::array out;
  for (const double error : kDecades) {
    // Below its floor the reference cannot tell errors apart.
    if (error < m.reference.floor()) break;
    std::string best;
    double cpu = INFINITY;
    for (const WorkPoint& p : m.points) {
      const auto c = cpu_at_error(m.points, p.integrator, error);
      if (c && *c < cpu) cpu = *c, best = p.integrator;
    }
    if (!best.empty())
      out.push_back(json::object{{"error", error}, {"integrator", best}, {"cpu_seconds", cpu}});
  }
  return out;
}

}  // namespace

std::optional<double> cpu_at_error(const std::vector<WorkPoint>& points, std::string_view integrator,
                                   double error) {
  std::optional<double> best;
  const WorkPoint* before = nullptr;
  for (const WorkPoint& p : points) {
    if (p.integrator != integrator || !(p.error_end > 0) || !std::isfinite(p.error_end)) continue;
    if (p.error_end <= error) {
      double cpu = p.cpu_seconds;
      // Between two points the curve is straight in log-log; a first point that is good enough is taken as it
      // is.
      if (before && before->error_end > error && before->cpu_seconds > 0 && p.cpu_seconds > 0) {
        const double w = std::log(before->error_end / error) / std::log(before->error_end / p.error_end);
        cpu = before->cpu_seconds * std::pow(p.cpu_seconds / before->cpu_seconds, w);
      }
      if (!best || cpu < *best) best = cpu;
    }
    before = &p;
  }
  return best;
}

const DefTable& work_precision_table() {
  using P = WorkPrecisionParams;
  static const DefTable t =
      TableOf<P>("CPU time against error of every method on this scene")
          .text("system", &P::system, "system whose method varies; the first that has one when left out")
          .text("quantity", &P::quantity,
                "field whose error is measured; state: all coordinates of the system; expect, with refine: "
                "what the scene expects to equal a number at its end")
          .texts("integrators", &P::integrators, {0, 64}, "methods; all that suit the system when left out")
          .numbers("steps", &P::steps, "s", above(0), {0, 64}, "steps of the fixed-step methods")
          .numbers("tolerances", &P::tolerances, "1", above(0), {0, 64}, "tolerances of the adaptive methods")
          .number("horizon", &P::horizon, "s", above(0),
                  "simulated time; else as much of the duration as the budget allows")
          .integer("samples", &P::samples, between(1, 1000), "instants at which paths are compared")
          .integer("repeats", &P::repeats, between(1, 100), "runs, of which the median time counts")
          .number("budget", &P::budget, "s", between(0.1, 1e5), "CPU time for the whole study")
          .choice("refine", &P::refine, refine_names(),
                  "what is refined along a curve; time: steps and tolerances; space: the system's resolution "
                  "at the scene's own steps; both: steps in proportion to the spacing")
          .integer("halvings", &P::halvings, between(3, 20),
                   "most halvings of the spacing, where it is refined")
          .build();
  return t;
}

WorkMeasurement measure_work(const json::value& scene, const WorkPrecisionParams& params,
                             StudyContext& context) {
  return Measurer(scene, params, context).run();
}

void describe_reach(const WorkMeasurement& m, json::object& summary) {
  if (m.horizon < m.duration) {
    summary["note"] = "the budget reaches " + short_number(m.horizon, 3) + " s of the scene's " +
                      short_number(m.duration, 3) + " s; give a horizon or a larger budget";
  }
  if (m.reference.meaningless()) {
    summary["warning"] =
        "two accurate methods differ by more than a hundredth before the horizon: the motion is chaotic or "
        "discontinuous, and errors of single paths mean nothing there; shorten the horizon or compare "
        "invariants";
  }
}

StudyResult run_work_precision(const json::value& scene, const void* def, StudyContext& context) {
  const auto& params = *static_cast<const WorkPrecisionParams*>(def);
  const bool in_time = params.refine == Refine::time;
  const WorkMeasurement m =
      in_time ? measure_work(scene, params, context) : measure_refined_work(scene, params, context);
  StudyResult r;
  r.table.columns = {{"integrator", ""},  {"setting", ""}, {"cpu_seconds", "s"}, {"error_end", "1"},
                     {"error_path", "1"}, {"steps", "1"},  {"status", ""}};
  if (!in_time)
    r.table.columns = {{"integrator", ""},   {"refined", "1"},   {"setting", ""},
                       {"cpu_seconds", "s"}, {"error_end", "1"}, {"status", ""}};
  const json::value* name = scene.as_object().if_contains("name");
  const std::string of = name && name->is_string() ? ": " + std::string(name->as_string()) : "";
  r.plot = {.title = "Run time against error" + of,
            .x_label = "relative error of " + params.quantity + " at the end",
            .y_label = "CPU time in s"};
  for (const WorkPoint& p : m.points) {
    if (in_time) {
      r.table.rows.push_back({p.integrator, p.setting, p.cpu_seconds, p.error_end, p.error_path,
                              static_cast<double>(p.steps), p.status});
    } else {
      r.table.rows.push_back({p.integrator, p.refined, p.setting, p.cpu_seconds, p.error_end, p.status});
    }
    if (!(p.error_end > 0) || !std::isfinite(p.error_end) || p.error_end > 10) continue;
    if (r.plot.series.empty() || r.plot.series.back().name != p.integrator)
      r.plot.series.push_back({.name = p.integrator});
    r.plot.series.back().x.push_back(p.error_end);
    r.plot.series.back().y.push_back(p.cpu_seconds);
  }
  json::array refused;
  for (const auto& f : m.refused)
    refused.push_back(json::object{{"integrator", f.integrator}, {"reason", f.reason}});
  r.summary = {{"horizon", m.horizon},
               {"refine", refine_names()[static_cast<size_t>(params.refine)]},
               {in_time ? "reference" : "measured_against",
                in_time ? json::value(describe_reference(m.reference)) : json::value(m.reference.method)},
               {"cheapest", cheapest(m)},
               {"refused", std::move(refused)}};
  describe_reach(m, r.summary);
  return r;
}

}  // namespace truestep
