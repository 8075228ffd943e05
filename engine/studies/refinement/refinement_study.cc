#include "engine/studies/refinement/refinement_study.h"

#include <algorithm>
#include <array>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/base/thread_clock.h"
#include "engine/integrators/table/integrators.h"
#include "engine/studies/scene_variant.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr int kUsualHalvings = 4;
constexpr double kStiffSteps = 5000;  // steps of an explicit method over the horizon; beyond that implicit
                                      // ones come first
constexpr double kTimeShare = 0.02;   // share of the expected spatial error that time may add
constexpr double kRounding = 1.001, kWithin = 0.9;  // of a method's largest stable step
constexpr double kFallsFaster = 2.5;                // factor per halving of the spacing
constexpr double kTimeAtFirst = 1e-7;               // when no error is expected yet

double root_mean_square(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum / static_cast<double>(std::max<size_t>(1, v.size())));
}

bool is_stiff(const World& world, size_t system, double horizon) {
  const Integrator* method = world.system(system).integration().method;
  if (!method) return false;
  if (method->kind == Integrator::Kind::implicit || method->real_limit > 50) return true;
  const auto limit =
      world.system(system).limit(Limit::stable_dt, world.initial_state().systems[system], world.dt());
  return limit && horizon / *limit > kStiffSteps;
}

}  // namespace

RefinementStudy::RefinementStudy(const json::value& scene, const ConvergenceParams& p, StudyContext& context,
                                 Steps steps)
    : p_(p),
      context_(context),
      steps_(steps),
      ladder_(scene, p.system, context),
      coarsest_(build_world(ladder_.document(0), context)),
      request_(ladder_.request(p.quantity, coarsest_)) {
  const Scene& s = coarsest_.scene();
  horizon_ = p.horizon.value_or(s.header.time.duration);
  substep_ = s.substep();
  order_ = ladder_.promised_order();
  if (p.refine == Refine::both) choose_steps();
}

void RefinementStudy::run() {
  const int64_t halvings = p_.halvings.value_or(kUsualHalvings);
  const double started = thread_cpu_seconds();
  double last = 0;
  for (int k = 0; k <= halvings; ++k) {
    context_.progress(static_cast<double>(k) / static_cast<double>(halvings + 1), name(k));
    const double before = thread_cpu_seconds(), left = p_.budget - (before - started);
    // Twice as fine costs at least twice as much; otherwise the growth from the last two levels.
    if (k > 0 && left < last * growth_) {
      note_ = "the budget reaches " + std::to_string(k) + " resolutions; a larger one allows more";
      break;
    }
    if (!add_level(k, left)) break;
    const double took = thread_cpu_seconds() - before;
    growth_ = last > 0 ? std::clamp(took / last, 2.0, 32.0) : 4;
    last = took;
  }
  if (levels_.empty()) {
    throw Error("study_failed", "not even the coarsest resolution finishes within the time budget",
                {"/horizon", "too_long", "not even the coarsest resolution gets so far within the budget",
                 short_number(horizon_, 3), "a larger budget or a shorter horizon", "", "s"});
  }
}

std::string RefinementStudy::name(int level) const {
  return "resolution " + short_number(std::ldexp(1 / ladder_.coarsening(), level), 3);
}

// For `both`: the method, and how its step follows the spacing.
void RefinementStudy::choose_steps() {
  const int own = static_cast<int>(std::log2(ladder_.coarsening()));
  const json::value document = ladder_.document(own);
  const World world = build_world(document, context_);
  const Integration at_work = world.system(ladder_.system()).integration();
  method_ = p_.integrator.empty() ? at_work.method : find_integrator(p_.integrator);
  if (!p_.integrator.empty() && !method_) {
    throw Error("scene_invalid", "there is no integrator \"" + p_.integrator + '"',
                {"/integrator", "unknown_choice", "there is no such integrator", '"' + p_.integrator + '"',
                 "", "", ""});
  }
  const int in_space = order_ > 0 ? order_ : 2, in_time = method_ ? method_->order : in_space;
  adaptive_ = method_ && method_->stepping == Integrator::Stepping::adaptive;
  if (steps_ == Steps::keep) {
    power_ = 0;
    first_ = adaptive_ && at_work.options ? at_work.options->tolerance : p_.step.value_or(substep_);
    return;
  }
  if (adaptive_) {
    const double own_tolerance = at_work.options ? at_work.options->tolerance : 1e-6;
    first_ = std::ldexp(own_tolerance, in_space * own);
    power_ = in_space, promised_ = order_;
    return;
  }
  power_ = (in_space + in_time - 1) / in_time;
  double largest = p_.step.value_or(std::ldexp(substep_, power_ * own));
  // An explicit method's limit may fall like dx^2; a smaller step gains nothing.
  const double held = limit(own), finer = limit(own + 1), coarsest = limit(0);
  if (power_ == 1 && held > kFallsFaster * finer) {
    power_ = 2;
    largest = p_.step.value_or(std::ldexp(substep_, power_ * own));
  }
  if (!p_.step && largest > kRounding * coarsest) largest = kWithin * coarsest;
  promised_ = order_ > 0 ? std::min(order_, power_ * in_time) : 0;
  first_ = horizon_ / std::max(1.0, std::ceil(horizon_ / largest - 1e-9));
}

// s, largest step that the method tolerates; infinity: any.
double RefinementStudy::limit(int level) const {
  json::value d = ladder_.document(level);
  if (method_) set_integrator(d, ladder_.system(), method_->name);
  const World w = build_world(d, context_);
  return w.system(ladder_.system())
      .limit(Limit::stable_dt, w.initial_state().systems[ladder_.system()], substep_)
      .value_or(INFINITY);
}

// Returns false when it did not finish in time.
bool RefinementStudy::add_level(int k, double left) {
  const json::value document = ladder_.document(k);
  const World world = build_world(document, context_);
  Level level{.refined = std::ldexp(1 / ladder_.coarsening(), k)};
  level.rows = world.system(ladder_.system()).parts().at(0).max_rows;
  Trace t;
  if (p_.refine == Refine::space) {
    auto found = in_time(document, world, left);
    if (!found) {
      note_ = "the budget reaches " + std::to_string(k) + " resolutions; a larger one allows more";
      return false;
    }
    // Relative to an error against an exact solution in that error's own norm: a front displaced by a
    // fraction of a cell is little in the mean and much in the mean square.
    const double size = root_mean_square(found->trace.values.back());
    uncertainty_ =
        std::max(uncertainty_, found->observed_difference && size > 0 ? *found->observed_difference / size
                                                                      : found->uncertainty);
    methods_ = found->method + ", checked by " + found->checked_by;
    t = std::move(found->trace);
  } else {
    t = with_method(document, k, left, level);
  }
  level.cpu_seconds = t.cpu_seconds;
  level.status = t.end == Trace::End::complete   ? "ok"
                 : t.end == Trace::End::unstable ? "unstable"
                                                 : "over budget";
  const bool complete = t.end == Trace::End::complete;
  // Errors against an exact solution need no places that resolutions share, which particles do not have.
  if (says_exact()) {
    common_.emplace_back();
  } else if (complete) {
    common_.push_back(ladder_.at_common(coarsest_, world, request_.field, t.values.back()));
  } else {
    common_.emplace_back(common_.empty() ? 1 : common_[0].size(), NAN);
  }
  if (!request_.observables.empty()) {
    const auto off = [&] {
      if (expects()) return ladder_.off_expected(t.observed.back());
      return t.observed.back()[0] / root_mean_square(t.values.back());
    };
    exact_.push_back(complete ? off() : NAN);
  }
  levels_.push_back(std::move(level));
  return t.end != Trace::End::over_budget;
}

// Spatial error of the next level, extrapolated from the existing ones.
double RefinementStudy::expected_error() const {
  const double falls = std::exp2(order_ > 0 ? order_ : 2);
  const size_t n = common_.size();
  if (!exact_.empty()) return exact_.back() / falls;
  if (n > 1) return relative_error(common_[n - 2], common_[n - 1]) / (falls * falls);
  return kTimeAtFirst / kTimeShare;
}

// The system's equations at this resolution, solved until time adds little: by one method at ever tighter
// tolerances, or, when steps do more than integrate, like any reference.
std::optional<Reference> RefinementStudy::in_time(const json::value& document, const World& world,
                                                  double left) {
  const double steps = std::max(1.0, std::round(horizon_ / substep_));
  const bool split = steps_matter(world) || !world.system(ladder_.system()).integration().method;
  request_.steps_per_sample = static_cast<uint64_t>(split ? steps : std::min(steps, 8.0));
  if (split) return find_reference(document, request_, horizon_, left, context_).reference;
  const double enough = std::clamp(kTimeShare * expected_error(), 1e-12, kTimeAtFirst);
  const bool stiff = is_stiff(world, ladder_.system(), horizon_);
  constexpr std::array<const char*, 3> kStiff = {"radau5", "sdirk4", "cvode_bdf"};
  constexpr std::array<const char*, 3> kUsual = {"dop853", "tsit5", "radau5"};
  for (const char* name : stiff ? kStiff : kUsual) {
    double spent = 0;
    std::optional<Trace> before;
    for (double tolerance = enough; tolerance > 0.9e-13; tolerance *= 0.1) {
      auto now = with_tolerance(document, name, tolerance, left - spent);
      if (!now) break;
      spent += now->cpu_seconds;
      if (now->end != Trace::End::complete) return std::nullopt;
      if (before) {
        Reference r;
        r.uncertainty = relative_error(before->values.back(), now->values.back());
        if (r.uncertainty <= enough || tolerance < 9e-13) {
          r.method = std::string(name) + " at tolerance " + short_number(tolerance, 3);
          r.checked_by = "itself at ten times that";
          r.trace = std::move(*now);
          return r;
        }
      }
      before = std::move(now);
    }
  }
  return std::nullopt;
}

// Empty when the method does not serve the system.
std::optional<Trace> RefinementStudy::with_tolerance(json::value document, const char* name, double tolerance,
                                                     double cpu_limit) {
  request_.cpu_limit = cpu_limit;
  set_dt(document, horizon_ / static_cast<double>(request_.steps_per_sample));
  set_integrator(document, ladder_.system(), name);
  set_tolerance(document, ladder_.system(), tolerance);
  try {
    return trace(build_world(document, context_), request_, context_);
  } catch (const Error& e) {
    if (e.code() == "cancelled") throw;
    return std::nullopt;
  }
}

Trace RefinementStudy::with_method(json::value document, int k, double left, Level& level) {
  level.setting = std::ldexp(first_, -power_ * k);
  const double step = adaptive_ ? substep_ : level.setting;
  request_.steps_per_sample = static_cast<uint64_t>(std::max(1.0, std::round(horizon_ / step)));
  request_.cpu_limit = left;
  set_dt(document, horizon_ / static_cast<double>(request_.steps_per_sample));
  if (method_) set_integrator(document, ladder_.system(), method_->name);
  if (adaptive_) set_tolerance(document, ladder_.system(), level.setting);
  return trace(build_world(document, context_), request_, context_);
}

}  // namespace truestep
