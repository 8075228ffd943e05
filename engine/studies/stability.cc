#include "engine/studies/stability.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/errors.h"
#include "engine/base/random.h"
#include "engine/base/text/short_number.h"
#include "engine/integrators/control/spectrum.h"
#include "engine/integrators/table/integrators.h"
#include "engine/studies/scene_variant.h"
#include "engine/studies/trajectory.h"

namespace truestep {

namespace json = boost::json;

namespace {

double largest_move(std::span<const double> x, const std::vector<double>& from) {
  if (x.size() != from.size()) return 0;
  double most = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    const double d = std::abs(x[i] - from[i]);
    if (!(d <= most)) most = d;  // NaN counts as largest
  }
  return most;
}

/// A stability limit, and spans above it where steps are stable again.
class BorderSearch {
 public:
  BorderSearch(const json::value& scene, const StabilityParams& p, size_t system, std::string method,
               StudyContext& c)
      : scene_(scene), params_(p), system_(system), method_(std::move(method)), context_(c) {}

  struct Span {
    double from = 0, to = 0;  ///< s
  };
  struct Found {
    double dt = 0;
    enum class Kind : uint8_t { limit, always, never, over_budget } kind = Kind::limit;
    int runs = 0;
    std::vector<Span> again;  ///< stable spans above the first limit
  };

  /// The first limit between `guess` / 256 and 256 `guess`, and stable spans within a factor of four above
  /// it. Steps are tried from below, `resolution` apart near the guess and near a limit, as some compositions
  /// lose stability over only 1.4 %; every limit is bisected. To end within `cpu_limit` s, runs get shorter,
  /// down to kFewestSteps, then steps set further apart; at worst the result is incomplete.
  Found find(double guess, double cpu_limit) {
    const double begin = thread_cpu_seconds();
    stop_at_ = begin + cpu_limit;
    Found found{.dt = guess / 256};
    try {
      plan_runs(guess / 256, cpu_limit);
      if (!stable(guess / 256)) return {guess / 256, Found::Kind::never, runs_, {}};
      double low = guess / 256;
      // From below in doublings, finely around the guess, then in doublings again.
      while (low < guess / kNear && advance(low, 2 * low, found)) {
      }
      while (!border_ && low < kNear * guess && advance(low, low * (1 + resolution_), found)) {
      }
      while (!border_ && low < 256 * guess && advance(low, 2 * low, found)) {
      }
      found.runs = runs_;
      if (!border_) return found.dt = low, found.kind = Found::Kind::always, found;
      find_again(found);
    } catch (const OverBudget&) {
      if (!border_) found.kind = Found::Kind::over_budget;
    } catch (const TooLong&) {
      if (!border_) found.kind = Found::Kind::always;
    }
    found.runs = runs_;
    return found;
  }
  int64_t steps() const { return steps_; }
  /// Spans narrower than this fraction of the step may have been missed.
  double resolution() const { return resolution_; }

 private:
  static constexpr int64_t kFewestSteps = 60;
  static constexpr double kNear = 4;        // finely from guess / 4 to 4 guess
  static constexpr double kUsualRuns = 60;  // besides the fine ones
  static constexpr double kFinest = 0.01, kCoarsest = 0.25;
  struct OverBudget {};
  struct TooLong {};  ///< scenes do not accept such a step

  // Fine steps over a factor of kNear^2, and of kNear beyond the limit.
  static double fine_runs(double resolution) { return 3 * std::log(kNear) / std::log1p(resolution); }

  void plan_runs(double dt, double cpu_limit) {
    constexpr int64_t kProbe = 16;
    const double begin = thread_cpu_seconds();
    steps_ = kProbe;
    stable(dt);
    // Every run builds its own world.
    const double rest = thread_cpu_seconds() - begin - stepping_, each = stepping_ / kProbe;
    const auto affordable = [&] { return (cpu_limit / (kUsualRuns + fine_runs(resolution_)) - rest) / each; };
    resolution_ = kFinest;
    while (resolution_ < kCoarsest &&
           affordable() < static_cast<double>(std::min(params_.steps, 4 * kFewestSteps)))
      resolution_ *= 1.5;
    steps_ = params_.steps;
    if (affordable() < static_cast<double>(steps_)) {
      steps_ = std::min(steps_, std::max(kFewestSteps, static_cast<int64_t>(affordable())));
    }
    reaches_.clear();
    runs_ = 0;
  }
  // Advances from `low`, which is stable, to `next`; false at a limit, which is then known.
  bool advance(double& low, double next, Found& found) {
    if (stable(next)) {
      found.dt = low = next;
      return true;
    }
    // There may be more than one limit in between: the lowest is wanted.
    double high = next;
    if (next > low * (1 + 1.5 * resolution_)) {
      double step = low;
      while (step * (1 + resolution_) < next && stable(step * (1 + resolution_))) {
        found.dt = step *= 1 + resolution_;
      }
      low = step, high = std::min(next, step * (1 + resolution_));
    }
    border_ = high;
    found.dt = bisect(low, high);
    return false;
  }
  /// `holds` and `fails`: steps on either side of a limit. Returns the last stable step.
  double bisect(double holds, double fails) {
    while (std::abs(fails - holds) > params_.accuracy * std::min(holds, fails)) {
      const double middle = 0.5 * (holds + fails);
      (stable(middle) ? holds : fails) = middle;
    }
    return holds;
  }
  void find_again(Found& found) {
    bool holds = false;
    const double end = kNear * *border_;
    double last = *border_;
    for (double dt = last * (1 + resolution_); dt < end; last = dt, dt *= 1 + resolution_) {
      const bool now = stable(dt);
      if (now && holds) found.again.back().to = dt;
      if (now == holds) continue;
      if (now) {
        found.again.push_back({bisect(dt, last), dt});
      } else {
        found.again.back().to = bisect(last, dt);
      }
      holds = now;
    }
  }
  bool stable(double dt) {
    ++runs_;
    json::value d = scene_;
    set_dt(d, dt);
    set_integrator(d, system_, method_);
    std::optional<World> built;
    try {
      built.emplace(require_scene(read_scene(d)));
    } catch (const Error& e) {
      // Long steps are refused with a pointer; faults that shorter steps share are left to the caller.
      if (e.code() != "scene_invalid" || runs_ < 3) throw;
      throw TooLong{};
    }
    const World& world = *built;
    WorldState state = world.initial_state();
    State& s = state.systems[system_];
    const auto x = s.at("position");
    const std::vector<double> start(s.f64(x).begin(), s.f64(x).end());
    disturb(s);
    Workspace workspace;
    const double bound = 10 * std::max(reach(dt, start), 1e-6 * scale(start));
    const double begin = thread_cpu_seconds();
    try {
      for (int64_t n = 0; n < steps_; ++n) {
        if (n % 64 == 0) context_.check();
        if (thread_cpu_seconds() > stop_at_) throw OverBudget{};
        step(world, state, workspace);
        if (!(largest_move(state.systems[system_].f64(x), start) <= bound)) return false;
      }
    } catch (const Instability&) {
      return false;
    }
    stepping_ = thread_cpu_seconds() - begin;
    return true;
  }

  // Uncoupled systems are skipped: they say nothing about this one.
  void step(const World& world, WorldState& state, Workspace& workspace) const {
    static const ThreadArena kSerial(1);
    if (!world.couplings().empty()) return world.step(state, workspace, kSerial, {});
    const double h = world.scene().substep();
    const auto substeps = static_cast<uint64_t>(world.scene().substeps());
    for (uint64_t k = 0, n = state.step * substeps; k < substeps; ++k, ++n) {
      world.system(system_).step(
          state.systems[system_],
          {.t = static_cast<double>(n) * h, .h = h, .step = n, .workspace = workspace, .arena = kSerial});
    }
    ++state.step;
  }
  // A small push on every velocity gives an unstable mode something to grow from.
  void disturb(State& s) const {
    const auto v = s.f64(s.at("velocity"));
    const auto x = s.f64(s.at("position"));
    const double size = 1e-7 * scale({x.begin(), x.end()});
    for (size_t i = 0; i < v.size(); ++i) v[i] += size * (uniform4(11, 0, i)[0] - 0.5);
  }
  static double scale(const std::vector<double>& x) {
    double most = 1e-3;
    for (const double c : x) most = std::max(most, std::abs(c));
    return most;
  }
  // How far the motion gets in the time of `steps` steps of dt, from one run at a small step.
  double reach(double dt, const std::vector<double>& start) {
    const double horizon = dt * static_cast<double>(steps_);
    if (reaches_.empty()) follow(start);
    double most = 0, half = 0;
    const double end = reaches_.back().first;
    for (const auto& [t, distance] : reaches_) {
      if (t <= horizon || most == 0) most = std::max(most, distance);
      if (t <= 0.5 * end) half = std::max(half, distance);
    }
    // Longer than the reference: what still drifts there goes on as freely moving or falling bodies do.
    const double longer = horizon / end;
    return longer > 1 && most > 1.5 * half ? most * longer * longer : most;
  }
  // The reference motion: the scene's own method at its own step.
  void follow(const std::vector<double>& start) {
    const World world = build_world(scene_, context_);
    WorldState state = world.initial_state();
    Workspace workspace;
    double most = 0;
    try {
      for (int64_t n = 0; n < steps_ && thread_cpu_seconds() < stop_at_; ++n) {
        context_.check();
        step(world, state, workspace);
        most = std::max(
            most, largest_move(state.systems[system_].f64(state.systems[system_].at("position")), start));
        reaches_.emplace_back(static_cast<double>(n + 1) * world.dt(), most);
      }
    } catch (const Instability&) {
      // Compared with the motion up to there.
    }
    if (reaches_.empty()) reaches_.emplace_back(0, most);
  }

  const json::value& scene_;
  const StabilityParams& params_;
  size_t system_;
  std::string method_;
  StudyContext& context_;
  std::vector<std::pair<double, double>> reaches_;
  double stop_at_ = 0;
  int64_t steps_ = 0;
  double stepping_ = 0;  // s that the steps of the last stable run took
  double resolution_ = kFinest;
  std::optional<double> border_;  // a step just above the first limit
  int runs_ = 0;
};

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
