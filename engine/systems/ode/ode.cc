#include "engine/systems/ode/ode.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "engine/base/byte_hash.h"
#include "engine/systems/ode/ode_method.h"
#include "engine/systems/ode/ode_scratch.h"
#include "engine/systems/ode/ode_tracers.h"

namespace truestep::ode {

using C = OdeColumns;

namespace {

/// Events per step; more are considered an endless pile-up.
constexpr int kMaxEventsPerStep = 1000;
}  // namespace

Ode::Ode(const OdeDef& def, const BuildContext& context)
    : def_(def), model_(compile_ode(def)), seed_(context.seed) {
  tolerance_.relative = tolerance_.absolute = kOdeTolerance;
  if (model_.size() > 0) {
    OdeMethod chosen = choose_ode_method(def_, model_, context.dt);
    method_ = chosen.row;
    why_this_method_ = std::move(chosen.why);
    tolerance_.relative = chosen.relative_tolerance, tolerance_.absolute = chosen.absolute_tolerance;
  }
  tolerance_.relative = def_.relative_tolerance.value_or(def_.tolerance.value_or(tolerance_.relative));
  tolerance_.absolute = def_.absolute_tolerance.value_or(def_.tolerance.value_or(tolerance_.absolute));
  tolerance_.absolute_each = model_.absolute_tolerances;
  options_ = def_.choice().options;
  if (method_) set_integration({method_, &options_, nullptr});
  constexpr int kPath = 400;
  trail_ = static_cast<size_t>(def_.trail.value_or(model_.bodies <= 16 && !def_.tracers ? kPath : 0));
  if (def_.tracers) {
    const auto x = tracer_positions(*def_.tracers, seed_);
    rows_ = x.size() / 3;
    const double width = def_.tracers->box_max.x - def_.tracers->box_min.x;
    for (size_t i = 0; i < rows_; ++i) {
      tags_.push_back(width > 0 ? (x[3 * i] - def_.tracers->box_min.x) / width : 0);
    }
    trail_ = 0;
  } else {
    rows_ = model_.bodies * (1 + trail_);
  }
  sort_states();
  show();
  set_remedies(
      {"a look at the equations: no method continues past a time where the solution blows up or jumps (an "
       "event can stop before it, or set states)"});
  plan_stages();
}

void Ode::plan_stages() {
  if (method_) {
    add_stage("integrate",
              std::to_string(model_.size()) + " states with " + std::string(method_->name) + ": " +
                  why_this_method_ +
                  (model_.stops.empty() ? "" : ", stopping where comparisons of time in them change") +
                  (model_.switched == 0 ? ""
                                        : ", switching where expressions under a sign cross zero and sliding "
                                          "along it where both sides push back"),
              [this](State& s, const StepInput& in) { integrate(s, in); });
  } else {
    skip_stage("integrate", "no states");
  }
  if (def_.events.empty()) skip_stage("events", "none given");
  if (def_.tracers) {
    add_stage("tracers", std::to_string(rows_) + " points",
              [this](State& s, const StepInput& in) { carry_tracers(s, in); });
  } else {
    skip_stage("tracers", "none given");
  }
  if (model_.bodies > 0 && !def_.tracers) {
    add_stage("path",
              "drawn: " + std::to_string(model_.bodies) + " points and " + std::to_string(trail_) +
                  " past ones of each",
              [this](State& s, const StepInput& in) {
                draw_path(s, static_cast<double>(in.step + 1) * in.h, in.workspace);
              });
  }
}

State Ode::initial_state() const {
  State s;
  const auto add = [&s]<class T>(C::Index expected, const char* name, const char* unit, uint32_t width,
                                 Role role, const std::vector<T>& values) {
    const auto c = s.add({name, unit, scalar_of<T>(), width, role}, values.size() / width);
    assert(c == expected);
    std::copy(values.begin(), values.end(), s.span<T>(c).begin());
  };
  const size_t events = model_.events.size();
  add(C::kStates, "states", "1", 1, Role::position, model_.initial);
  add(C::kTracers, "tracers", "m", 3, Role::position,
      def_.tracers ? tracer_positions(*def_.tracers, seed_) : std::vector<double>{});
  add(C::kParameters, "parameters", "1", 1, Role::internal, model_.parameter_values);
  add(C::kCarry, "integrator.carry", "1", 1, Role::internal, std::vector<double>(2));
  add(C::kEventCounts, "events.counts", "1", 1, Role::internal, std::vector<uint64_t>(events));
  add(C::kEventSigns, "events.signs", "1", 1, Role::internal, std::vector<int32_t>(model_.guards.outputs()));
  add(C::kStopped, "stopped", "1", 1, Role::internal, std::vector<double>(2));
  std::vector<double> invariants(model_.invariants.outputs());
  if (!invariants.empty()) {
    OdeEvaluation evaluate(model_.invariants);
    evaluate.set_parameters(model_.parameter_values);
    evaluate(0, model_.initial.data(), model_.size(), model_.parameter_values.size(), invariants.data());
  }
  add(C::kInvariantsAtStart, "invariants.start", "1", 1, Role::internal, invariants);
  add(C::kWork, "integrator.work", "1", 1, Role::internal, std::vector<uint64_t>(kOdeWorkCounters));
  add(C::kMemory, "integrator.memory", "1", 1, Role::sentinel,
      std::vector<double>(method_ && method_->memory ? method_->memory(model_.size()) : 0, NAN));
  // NaN where the plot's formulas have no value: the logarithm of what has become negative.
  add(C::kTrail, "trail", "m", 3, Role::sentinel, std::vector<double>(def_.tracers ? 0 : 3 * rows_));
  if (!model_.contacts.empty()) {
    add(C::kResting, "events.resting", "1", 1, Role::internal, std::vector<int32_t>(model_.guards.outputs()));
  }
  if (model_.switched > 0) {
    add(sliding_column(), "sides.sliding", "1", 1, Role::internal, std::vector<int32_t>(model_.switched));
  }
  if (rows_ > 0 && !def_.tracers) {
    Workspace workspace;
    for (size_t k = 0; k <= trail_; ++k) draw_path(s, 0, workspace);
  }
  if (model_.guards.outputs() > 0) {
    Workspace workspace;
    Scratch& work = scratch(s, workspace);
    refresh_sides(s, work, 0);
    work.watcher->look(0, model_.initial.data());
    // A contact that starts at zero rests there; an event in either direction does not say on which side.
    for (uint32_t k = 0; k < model_.contacts.size(); ++k) {
      const Crossing direction = work.guards->directions()[k];
      if (s.span<int32_t>(C::kEventSigns)[k] != 0 || direction == Crossing::either) continue;
      if (work.contacts->possible(k)) settle(s, work, k, direction == Crossing::falling ? 1 : -1, 0);
      if (work.contacts->resting(k)) work.watcher->look(0, s.f64(C::kStates).data());
    }
  }
  return s;
}

Ode::Scratch& Ode::scratch(State& s, Workspace& workspace) const {
  Scratch& work = workspace.object<Scratch>("ode");
  if (work.model != &model_) {
    work.model = &model_;
    work.equations = std::make_unique<OdeEquations>(model_);
    work.contacts = std::make_unique<OdeContacts>(model_);
    work.slides = std::make_unique<OdeSlides>(model_);
    work.guards = std::make_unique<OdeGuards>(model_, *work.contacts, *work.slides);
    work.watcher = std::make_unique<EventWatcher>(*work.guards, work.guards->directions(), model_.size());
    work.plot = std::make_unique<OdeEvaluation>(model_.plot);
    work.stops = model_.stops.empty() ? nullptr : std::make_unique<OdeStops>(model_);
    work.event_values.clear();
    size_t most = 0;
    for (const OdeModel::Event& e : model_.events) {
      work.event_values.emplace_back(e.values);
      most = std::max(most, e.targets.size());
    }
    work.values.resize(most);
  }
  work.set_parameters(s.f64(C::kParameters));
  if (!model_.contacts.empty()) work.contacts->attach(s.span<int32_t>(C::kResting));
  if (model_.switched > 0) work.slides->attach(s.f64(C::kParameters), s.span<int32_t>(sliding_column()));
  work.watcher->attach(s.span<int32_t>(C::kEventSigns));
  return work;
}

void Ode::integrate(State& s, const StepInput& in) const {
  Scratch& work = scratch(s, in.workspace);
  const auto y = s.f64(C::kStates);
  if (def_.tracers) work.start.assign(y.begin(), y.end());
  // The next step begins exactly where this one ends. Times closer than `slack` are considered equal.
  const double t_end = static_cast<double>(in.step + 1) * in.h, slack = 1e-9 * in.h;
  double t = in.t;
  const bool adaptive = method_->stepping == Integrator::Stepping::adaptive;
  refresh_sides(s, work, t);
  int times = 0;
  while (t < t_end && s.f64(C::kStopped)[0] == 0) {
    const double timed = next_timed_event(t, slack);
    double target = timed < t_end - slack ? timed : t_end;
    const double due_at = target;
    if (work.stops) target = work.stops->next(t, target, slack);
    const double jump = target < due_at ? target : HUGE_VAL;
    if (adaptive && def_.max_step && target - t > *def_.max_step + slack) target = t + *def_.max_step;
    if (work.stops) {
      const double margin = std::max(1e-15 * std::abs(target), 1e-14 * in.h);
      work.equations->stay_within(t + margin, target - margin);
    }
    t = advance(s, work, in.workspace, t, target);
    if (t >= jump) forget(s);
    const auto& crossed = work.watcher->fired();
    if (crossed.empty() && target < due_at) continue;
    for (const uint32_t k : crossed) cross(s, work, k, t);
    const bool on_time = crossed.empty() && timed <= t_end + slack;
    for (size_t k = 0; on_time && k < model_.events.size(); ++k) {
      const OdeEventDef& e = model_.events[k].def;
      const double due = e.at ? *e.at : e.every ? std::round(timed / *e.every) * *e.every : -1;
      if (std::abs(due - timed) <= slack) fire(s, work, k, t);
    }
    if (!crossed.empty() || on_time) {
      refresh_sides(s, work, t);
      if (model_.guards.outputs() > 0) work.watcher->look(t, y.data());
      for (const auto& [guard, side] : work.departing) s.span<int32_t>(C::kEventSigns)[guard] = side;
      work.departing.clear();
      if (++times > kMaxEventsPerStep) {
        throw Instability("", "events",
                          crossed.empty() || work.guards->is_side(crossed[0])
                              ? 0
                              : static_cast<long long>(work.guards->event(crossed[0])),
                          "more than 1000 events in one step: they pile up; let one of them stop the system");
      }
    }
    work.watcher->clear();
  }
  for (size_t i = 0; i < y.size(); ++i) {
    if (!std::isfinite(y[i])) {
      throw Instability("", model_.labels[i], -1, '"' + model_.labels[i] + "\" became non-finite");
    }
  }
}

double Ode::advance(State& s, Scratch& work, Workspace& workspace, double t, double t_end) const {
  const auto carried = s.f64(C::kCarry);
  Carry carry{carried[0], carried[1]};
  Statistics statistics;
  Advance run{.f = *work.equations,
              .t = t,
              .t_end = t_end,
              .y = s.f64(C::kStates).data(),
              .workspace = workspace,
              .carry = carry,
              .memory = s.f64(C::kMemory)};
  const auto parameters = s.bytes(C::kParameters);
  run.surroundings = byte_hash(parameters.data(), parameters.size());
  // Beyond the next jump the equations are others: nothing learnt there may be gone on with.
  if (work.stops) run.surroundings = byte_hash(&t_end, sizeof t_end, run.surroundings);
  run.tolerance = tolerance_;
  run.newton_tolerance = options_.newton_tolerance;
  run.max_steps = static_cast<uint64_t>(options_.max_internal_steps);
  run.damping = options_.damping;
  run.watcher = model_.guards.outputs() > 0 ? work.watcher.get() : nullptr;
  run.statistics = &statistics;
  const bool rests = work.contacts->any();
  work.equations->rest_on(rests ? work.contacts.get() : nullptr);
  work.equations->slide_on(work.slides->any() ? work.slides.get() : nullptr);
  if (rests) work.contacts->remember(s.f64(C::kStates));
  try {
    method_->advance(run);
  } catch (Instability& e) {
    if (e.index >= 0 && static_cast<size_t>(e.index) < model_.size()) {
      e.quantity = model_.labels[static_cast<size_t>(e.index)];
      e.index = -1;  // the label names it
    }
    if (model_.switches) {
      throw Instability(
          "", e.quantity, e.index,
          e.what() + std::string("; the right-hand side switches where a state crosses a border "
                                 "(sign, <): if both sides push back to it, no step is short "
                                 "enough: smooth it, as tanh(v / 1e-3) for sign(v), or let an "
                                 "event set the state there"));
    }
    throw;
  }
  carried[0] = carry.step, carried[1] = carry.last_error;
  const auto done = s.span<uint64_t>(C::kWork);
  done[kOdeSteps] += statistics.steps, done[kOdeRejected] += statistics.rejected;
  done[kOdeRates] += statistics.rates, done[kOdeJacobians] += statistics.jacobians;
  return run.reached;
}

double Ode::next_timed_event(double t, double slack) const {
  double next = HUGE_VAL;
  for (const OdeModel::Event& e : model_.events) {
    if (e.def.at && *e.def.at > t + slack) next = std::min(next, *e.def.at);
    if (e.def.every) next = std::min(next, (std::floor((t + slack) / *e.def.every) + 1) * *e.def.every);
  }
  return next;
}

void Ode::forget(State& s) {
  std::ranges::fill(s.f64(C::kCarry), 0.0);
  std::ranges::fill(s.f64(C::kMemory), NAN);
}

void Ode::carry_tracers(State& s, const StepInput& in) const {
  if (s.f64(C::kStopped)[0] != 0) return;
  Scratch& work = scratch(s, in.workspace);
  const size_t n = model_.size();
  const double* end = s.f64(C::kStates).data();
  OdeSurroundings around{in.t, in.h, s.f64(C::kParameters), {work.start.data(), nullptr, end}};
  if (n > 0) {
    // Midpoint by Hermite's cubic, whose error is of the order of the tracers' own.
    for (auto* v : {&work.middle, &work.rate_start, &work.rate_end}) v->resize(n);
    work.equations->rate(in.t, work.start.data(), work.rate_start.data());
    work.equations->rate(in.t + in.h, end, work.rate_end.data());
    for (size_t i = 0; i < n; ++i) {
      work.middle[i] =
          0.5 * (work.start[i] + end[i]) + 0.125 * in.h * (work.rate_start[i] - work.rate_end[i]);
    }
  }
  around.states[1] = work.middle.data();
  move_tracers(model_, def_.tracers->method, around, s.f64(C::kTracers), in.arena);
}

void Ode::draw_path(State& s, double t, Workspace& workspace) const {
  Scratch& work = scratch(s, workspace);
  work.points.resize(3 * model_.bodies);
  (*work.plot)(t, s.f64(C::kStates).data(), model_.size(), model_.parameter_values.size(),
               work.points.data());
  double* path = s.f64(C::kTrail).data();
  const size_t length = 3 * (1 + trail_);
  for (size_t b = 0; b < model_.bodies; ++b, path += length) {
    std::copy_backward(path, path + length - 3, path + length);
    std::copy_n(work.points.data() + 3 * b, 3, path);
  }
}

std::unique_ptr<const System> make_ode(const void* def, const BuildContext& context) {
  return std::make_unique<Ode>(*static_cast<const OdeDef*>(def), context);
}

}  // namespace truestep::ode
