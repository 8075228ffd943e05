#include "engine/studies/precision/method_search.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/integrators/table/integrators.h"
#include "engine/session/expectation.h"
#include "engine/studies/scene_variant.h"

namespace truestep {

namespace json = boost::json;

namespace {

using JudgedBy = MethodAnswer::JudgedBy;

constexpr double kRuns = 10;                 // runs of the scene at the requested accuracy that a search may
                                             // cost
constexpr double kLeast = 0.04;              // s, less than creating a session costs anyway
constexpr double kShortStudy = 0.8;          // s, for scenes whose steps take milliseconds
constexpr double kPatience = 100;            // steps of slower scenes
constexpr double kWholeSearch = 24;          // runs that a search over the whole horizon takes
constexpr double kAim = 0.3, kEnough = 0.5;  // fractions of the tolerance: target of the settings, and good
                                             // enough
constexpr int64_t kMostSubsteps = 512;

// Methods that pay at a given error, according to the work-precision diagrams of docs/work_precision.md.
std::vector<std::string_view> worth_trying(double tolerance, bool stiff) {
  if (stiff) {
    if (tolerance > 1e-3) return {"tr_bdf2", "rodas5p", "radau5", "bdf2", "implicit_midpoint"};
    return {"radau5", "rodas5p", "cvode_bdf", "sdirk4"};
  }
  if (tolerance > 1e-3) return {"velocity_verlet", "rk4", "tsit5", "dopri5", "yoshida4"};
  if (tolerance > 1e-7) return {"dop853", "tsit5", "dopri5", "rk4", "rkn86", "yoshida6"};
  return {"dop853", "rkn1210", "ias15", "kahan_li8"};
}

class MethodSearch {
 public:
  MethodSearch(const json::value& document, const MethodQuestion& question, const StudyContext& context)
      : document_(document), question_(question), context_(context), started_(thread_cpu_seconds()) {}

  MethodAnswer run() {
    look();
    if (answer_.reference) {
      for (const std::string_view name : worth_trying(question_.tolerance, stiff_)) {
        if (left() <= 0) {
          answer_.out_of_time = true;
          break;
        }
        try_method(name);
        // One is enough to say what is reachable.
        if (beyond_reach_ && std::ranges::any_of(answer_.measured, [](const MeasuredMethod& m) {
              return std::isfinite(m.error);
            })) {
          break;
        }
      }
    }
    return std::move(answer_);
  }

 private:
  double left() const {
    if (std::chrono::steady_clock::now() >= context_.deadline) return 0;
    return limit_ - (thread_cpu_seconds() - started_);
  }

  // Finds out how fast the scene is, how much of its horizon can be measured, and against what.
  void look() {
    const World own = build_world(document_, context_);
    const double built = thread_cpu_seconds() - started_;
    const Scene& scene = own.scene();
    has_energy_ = own.observe(own.initial_state()).find("energy.total").has_value();
    dt_ = scene.header.time.dt;
    // The scene's present method.
    const Integrator* method = own.system(question_.system).integration().method;
    stiff_ = method && method->kind == Integrator::Kind::implicit;
    const double steps = std::max(1.0, std::round(question_.horizon / dt_));
    TraceRequest probe{.field = field(), .samples = static_cast<size_t>(std::min(steps, 64.0))};
    probe.cpu_limit = 0.02 * question_.budget;
    const Trace seen = trace(own, probe, context_);
    double per_step = seen.cpu_seconds / static_cast<double>(std::max<uint64_t>(1, seen.steps));
    per_step = std::max(per_step, accurate_step(probe));
    const double whole = std::max(steps, scene.header.time.duration / dt_) * per_step;
    limit_ = std::min({question_.budget, std::max(kLeast, kRuns * (built + whole)),
                       std::max(kShortStudy, kPatience * per_step)});
    const double affordable = left() / (kWholeSearch * per_step);
    const double measured = std::clamp(std::floor(affordable), std::min(steps, 8.0), steps);
    const double samples = std::min(16.0, measured);
    request_ = {.field = field(), .samples = static_cast<size_t>(samples)};
    request_.steps_per_sample = static_cast<uint64_t>(std::floor(measured / samples));
    answer_.measured_horizon = static_cast<double>(request_.steps_per_sample) * samples * dt_;
    growth_ = std::max(1.0, question_.horizon / answer_.measured_horizon);
    find_the_reference();
  }
  // CPU seconds per step at the requested accuracy.
  double accurate_step(const TraceRequest& probe) const {
    for (const std::string_view name : worth_trying(1e-4, stiff_)) {
      json::value d = document_;
      set_integrator(d, question_.system, name);
      set_tolerance(d, question_.system, std::max(1e-13, 0.1 * question_.tolerance));
      try {
        const Trace t = trace(build_world(d, context_), probe, context_);
        if (t.steps > 0) return t.cpu_seconds / static_cast<double>(t.steps);
      } catch (const Error& e) {
        if (e.code() == "cancelled") throw;
      }
    }
    return 0;
  }
  TraceField field() const { return {question_.system, question_.quantity}; }

  void find_the_reference() {
    const ReferenceEffort effort{.first_tolerance = std::clamp(1e-3 * question_.tolerance, 1e-12, 1e-7),
                                 .enough = 0.1 * question_.tolerance,
                                 .stiff = stiff_};
    const double interval = static_cast<double>(request_.steps_per_sample) * dt_;
    ReferenceSearch found =
        find_reference(document_, request_, interval, std::max(0.6 * left(), 1e-4), context_, effort);
    if (!found.reference) {
      answer_.judged_by = JudgedBy::nothing;
      answer_.out_of_time = true;
      return;
    }
    answer_.reference = std::move(found.reference);
    // Below this, two accurate runs differ by rounding alone. Above it, equations without an energy leave
    // nothing to judge by.
    constexpr double kRounding = 1e-10;
    const double unsure = answer_.reference->uncertainty;
    if (unsure > question_.tolerance) {
      if (unsure < kRounding || !has_energy_) {
        beyond_reach_ = true;
      } else {
        answer_.judged_by = JudgedBy::energy;
      }
    }
  }

  // At a guessed setting, then at those suggested by its errors.
  void try_method(std::string_view name) {
    const Integrator* row = find_integrator(name);
    const bool adaptive = row->stepping == Integrator::Stepping::adaptive;
    double setting = adaptive ? std::max(1e-13, 0.1 * question_.tolerance) : dt_;
    for (int tries = 0; tries < (beyond_reach_ ? 1 : 4) && left() > 0; ++tries) {
      const auto run = measure(name, setting, adaptive);
      if (!run) return;
      answer_.measured.push_back(*run);
      // Finishing would cost more than the result that is already good enough.
      if (answer_.best && run->cpu_seconds > 2 * answer_.best->cpu_seconds) return;
      const bool good = run->error <= kEnough * question_.tolerance;
      if (good && (!answer_.best || run->cpu_seconds < answer_.best->cpu_seconds)) answer_.best = *run;
      const double next = suggest(*run, *row, setting);
      const double change = next / setting;
      if (good && (change < 3 || tries > 1)) return;
      if (change == 1) return;
      setting = next;
    }
  }

  double suggest(const MeasuredMethod& run, const Integrator& row, double setting) const {
    const bool adaptive = row.stepping == Integrator::Stepping::adaptive;
    const double wanted = kAim * question_.tolerance;
    if (adaptive) {
      if (!std::isfinite(run.error)) return std::max(1e-14, 1e-2 * setting);
      const double factor = std::clamp(wanted / std::max(run.error, 1e-17), 1e-4, 1e3);
      return std::clamp(setting * factor, 1e-14, 1e-2);
    }
    double parts = dt_ / setting;
    parts *= std::isfinite(run.error) ? std::pow(run.error / wanted, 1.0 / row.order) : 4;
    const double whole = std::clamp(std::ceil(parts - 0.01), 1.0, static_cast<double>(kMostSubsteps));
    return dt_ / whole;
  }

  /// Empty when the method does not serve the system.
  std::optional<MeasuredMethod> measure(std::string_view name, double setting, bool adaptive) {
    json::value d = document_;
    set_integrator(d, question_.system, name);
    if (adaptive)
      set_tolerance(d, question_.system, setting);
    else
      set_at(d, "/time/substeps", static_cast<int64_t>(std::llround(dt_ / setting)));
    MeasuredMethod out{.integrator = std::string(name), .setting = setting};
    try {
      if (answer_.judged_by == JudgedBy::energy) {
        drift(d, out);
      } else {
        part(d, out);
      }
    } catch (const Error& e) {
      if (e.code() == "cancelled") throw;
      return std::nullopt;
    }
    return out;
  }

  void part(const json::value& d, MeasuredMethod& out) {
    TraceRequest request = request_;
    request.cpu_limit = std::max(left(), 1e-4);
    const Trace t = trace(build_world(d, context_), request, context_);
    out.cpu_seconds = t.cpu_seconds;
    if (t.end == Trace::End::over_budget) answer_.out_of_time = true;
    if (t.end != Trace::End::complete) {
      out.error = INFINITY;
      return;
    }
    const auto& reference = answer_.reference->trace.values;
    const double least = rounding_size(reference);
    double half = 0;
    for (size_t i = 0; i < reference.size(); ++i) {
      out.error = std::max(out.error, relative_error(t.values[i], reference[i], least));
      if (2 * i <= reference.size()) half = out.error;
    }
    // A run may equal the reference bit by bit when both take the scene's steps.
    out.error = std::max(out.error, answer_.reference->uncertainty);
    half = std::max(half, answer_.reference->uncertainty);
    // Over the rest of the horizon, errors grow as between the half and the end of the measured part, at
    // least linearly.
    const double power = half > 0 ? std::clamp(std::log2(out.error / half), 1.0, 2.0) : 1.0;
    if (growth_ > 1) out.error *= std::pow(growth_, power);
  }

  // The largest relative drift of the energy.
  void drift(const json::value& d, MeasuredMethod& out) {
    static const ThreadArena kSerial(1);
    Scene scene = require_scene(read_scene(d));
    ExpectParams wish;
    wish.quantity = "energy.drift";
    scene.header.expect = {wish};
    const World world(std::move(scene));
    Expectations watch(world.scene());
    WorldState state = world.initial_state();
    Workspace workspace;
    watch.add(world.observe(state));
    const uint64_t steps = request_.steps_per_sample * request_.samples;
    const double begin = thread_cpu_seconds();
    try {
      for (uint64_t n = 1; n <= steps; ++n) {
        if (n % 64 == 0) context_.check();
        world.step(state, workspace, kSerial, {});
        if (n % std::max<uint64_t>(1, steps / 64) == 0) watch.add(world.observe(state));
        if (n % 16 == 0 && left() < 0) {
          answer_.out_of_time = true;
          out.error = INFINITY;
          return;
        }
      }
      out.error = watch.verdicts()[0].measured.value_or(INFINITY);
    } catch (const Instability&) {
      out.error = INFINITY;
    }
    out.cpu_seconds = thread_cpu_seconds() - begin;
  }

  const json::value& document_;
  const MethodQuestion& question_;
  const StudyContext& context_;
  double started_, limit_ = 0, dt_ = 0, growth_ = 1;
  bool stiff_ = false, beyond_reach_ = false, has_energy_ = false;
  TraceRequest request_;
  MethodAnswer answer_;
};

}  // namespace

MethodAnswer search_method(const json::value& document, const MethodQuestion& question,
                           const StudyContext& context) {
  return MethodSearch(document, question, context).run();
}

}  // namespace truestep
