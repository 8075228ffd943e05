#include "engine/core/equations/force_system.h"

#include <cmath>
#include <limits>

#include "engine/base/errors.h"
#include "engine/core/equations/force_outputs.h"

namespace truestep {

ForceSystem::~ForceSystem() = default;

ForceSystem::ForceSystem(std::unique_ptr<const ForceField> field, const Integrator& method,
                         IntegratorOptions options)
    : field_(std::move(field)), method_(method), options_(options) {
  const State s = field_->initial_state();
  position_ = s.info(s.at("position"));
  velocity_ = s.info(s.at("velocity"));
  PartInfo part;
  part.fields = {{"position", position_.unit, position_.type, position_.width,
                  position_.width == 3 ? Meaning::position : Meaning::value},
                 {"velocity", velocity_.unit, velocity_.type, velocity_.width,
                  velocity_.width == 3 ? Meaning::velocity : Meaning::value}};
  part.max_rows = s.rows(s.at("position"));
  set_parts({std::move(part)});
  set_integration({&method_, &options_, field_.get()});
}

void ForceSystem::add_integration_stage(const std::string& why) {
  add_stage(
      "integrate",
      "advances position and velocity with " + std::string(method_.name) + (why.empty() ? "" : ": " + why),
      [this](State& s, const StepInput& in) { method_.step(*field_, s, in, options_); });
}

void ForceSystem::bound_speed() {
  static const ThreadArena kSerial(1);
  const State s = field_->initial_state();
  const auto x = s.f64(s.at("position")), v = s.f64(s.at("velocity"));
  Workspace workspace;
  Evaluation e{workspace, kSerial};
  std::vector<double> a(v.size());
  field_->acceleration({0, x, v, s}, a, e);
  const auto largest = [](std::span<const double> values) {
    double most = 0;
    for (const double c : values) most = std::max(most, std::abs(c));
    return most;
  };
  const double reach = 1 + largest(x);
  double speed = largest(v) + std::sqrt(2 * largest(a) * reach);
  if (const auto fastest = field_->stiffness(s)) speed += fastest->omega * reach;
  speed_limit_ = unexplained_speed(speed);
}

State ForceSystem::initial_state() const {
  State s = field_->initial_state();
  if (method_.prepare) method_.prepare(*field_, s);
  return s;
}

void ForceSystem::observe(const State& state, double t, Observables& out) const {
  const ForceEnergies e = force_energies(*this, state, t);
  out.add("energy.kinetic", e.kinetic, "J");
  if (e.potential) out.add("energy.potential", *e.potential, "J");
  if (e.total) out.add("energy.total", *e.total, "J");
  if (method_.observe) method_.observe(state, out);
}

std::optional<Energy> ForceSystem::energy(const State& state, double t, Workspace& workspace,
                                          const ThreadArena& arena) const {
  Evaluation e{workspace, arena};
  const Phase at{t, state.f64(state.at("position")), state.f64(state.at("velocity")), state};
  Energy out{.kinetic = field_->kinetic(at, e)};
  if (const auto potential = field_->potential(at, e)) {
    out.potential = *potential;
    out.exchange = exchange(state);
    // Terms that cancel at rest leave their rounding, which is no gain.
    out.slack = std::numeric_limits<double>::epsilon() * field_->cancelling_terms(state);
  }
  const bool limited =
      method_.kind == Integrator::Kind::explicit_ && method_.stepping == Integrator::Stepping::fixed;
  out.swing = limited ? Energy::kSwingNearLimit : Energy::kSwing;
  return out;
}

FieldView ForceSystem::field(const State& state, size_t, size_t field, std::vector<double>&) const {
  const ColumnInfo& info = field == 0 ? position_ : velocity_;
  const auto c = state.at(info.name);
  return {state.bytes(c).data(), info.type, state.rows(c), info.width};
}

std::optional<double> ForceSystem::limit(Limit which, const State& state, double) const {
  if (which == Limit::speed) return speed_limit_;
  if (which != Limit::stable_dt) return std::nullopt;
  const auto s = field_->stiffness(state);
  const StabilityInterval interval = stability_interval(method_, options_);
  // Adaptive methods divide a step themselves; unconditionally stable ones need no limit.
  if (!s || method_.stepping == Integrator::Stepping::adaptive || std::isinf(interval.imaginary)) {
    return std::nullopt;
  }
  const double dt = interval.largest_step(s->omega, s->damping);
  return std::isinf(dt) ? std::nullopt : std::optional(dt);
}

}  // namespace truestep
