// The exact solution as in any textbook, written so that the three damping regimes agree at their boundaries:
// with g = c / 2m and w^2 = |k/m - g^2|, x = e^{-gt} (x0 C + (v0 + g x0) S) where C = cos wt and S = sin(wt)
// / w (oscillating), cosh and sinh (creeping), 1 and t (critical).
#include <cassert>
#include <numbers>

#include "engine/math/block_sparse.h"
#include "engine/math/trig.h"
#include "engine/systems/oscillator/oscillator.h"

namespace truestep::oscillator {

namespace {

class OscillatorField : public ForceField {
 public:
  explicit OscillatorField(const OscillatorDef& def) : def_(def) {}

  State initial_state() const override {
    using C = OscillatorColumns;
    State s;
    const auto add = [&s](C::Index expected, const char* name, const char* unit, uint32_t width, Role role,
                          double v) {
      const auto c = s.add({name, unit, Scalar::f64, width, role}, 1);
      assert(c == expected);
      s.f64(c)[0] = v;
    };
    add(C::kPosition, "position", "m", 3, Role::position, def_.position);
    add(C::kVelocity, "velocity", "m/s", 3, Role::velocity, def_.velocity);
    add(C::kInverseMass, "inverse_mass", "1/kg", 1, Role::internal, 1 / def_.mass);
    add(C::kStiffness, "stiffness", "N/m", 1, Role::internal, def_.stiffness);
    add(C::kDamping, "damping", "N s/m", 1, Role::internal, def_.damping);
    add(C::kDriveForce, "drive_force", "N", 1, Role::internal, def_.drive_force);
    add(C::kDriveFrequency, "drive_frequency", "Hz", 1, Role::internal, def_.drive_frequency);
    s.add({"push.row", "1", Scalar::u32}, 0);
    s.add({"push.force", "N", Scalar::f64, 3}, 0);
    s.add({"push.remaining", "s"}, 0);
    add(C::kDisturbed, "disturbed", "1", 1, Role::internal, 0);
    return s;
  }

  void acceleration(const Phase& at, std::span<double> a, Evaluation&) const override {
    using C = OscillatorColumns;
    const State& s = at.state;
    const double f =
        -s.f64(C::kStiffness)[0] * at.x[0] - s.f64(C::kDamping)[0] * at.v[0] + prescribed_force(at);
    a[0] = f * s.f64(C::kInverseMass)[0];
    a[1] = a[2] = 0;
  }

  Dependence dependence() const override {
    return def_.damping != 0 ? Dependence::position_and_velocity : Dependence::position;
  }
  std::optional<double> potential(const Phase& at, Evaluation&) const override {
    return 0.5 * at.state.f64(OscillatorColumns::kStiffness)[0] * at.x[0] * at.x[0];
  }
  std::optional<double> dissipation(const Phase& at, Evaluation&) const override {
    return 0.5 * at.state.f64(OscillatorColumns::kDamping)[0] * at.v[0] * at.v[0] -
           prescribed_force(at) * at.v[0];
  }
  double kinetic(const Phase& at, Evaluation&) const override {
    return 0.5 * at.v[0] * at.v[0] / at.state.f64(OscillatorColumns::kInverseMass)[0];
  }

  bool has_jacobian() const override { return true; }
  bool symmetric_jacobian() const override { return true; }
  std::span<const double> inverse_mass(const State& s) const override {
    return s.f64(OscillatorColumns::kInverseMass);
  }
  void jacobian_pattern(const State&, BlockSparse& dfdx, BlockSparse& dfdv) const override {
    dfdx.set_pattern(1, 3, {});
    dfdv.set_pattern(1, 3, {});
  }
  void jacobian(const Phase& at, BlockSparse& dfdx, BlockSparse& dfdv, Evaluation&) const override {
    dfdx.set_zero();
    dfdv.set_zero();
    dfdx.block(0)[0] = -at.state.f64(OscillatorColumns::kStiffness)[0];
    dfdv.block(0)[0] = -at.state.f64(OscillatorColumns::kDamping)[0];
  }
  std::optional<Stiffness> stiffness(const State& s) const override {
    const double w = s.f64(OscillatorColumns::kInverseMass)[0];
    return Stiffness{std::sqrt(s.f64(OscillatorColumns::kStiffness)[0] * w),
                     s.f64(OscillatorColumns::kDamping)[0] * w};
  }

 private:
  // Push and drive, in N.
  static double prescribed_force(const Phase& at) {
    using C = OscillatorColumns;
    const State& s = at.state;
    double f = 0;
    for (size_t k = 0; k < C::kHands.pushes(s); ++k) f += C::kHands.push(s, k).force.x;
    if (const double amplitude = s.f64(C::kDriveForce)[0]; amplitude != 0) {
      f += amplitude * trig::sin(2 * std::numbers::pi * s.f64(C::kDriveFrequency)[0] * at.t);
    }
    return f;
  }

  OscillatorDef def_;
};

}  // namespace

std::unique_ptr<const ForceField> make_oscillator_field(const OscillatorDef& def) {
  return std::make_unique<OscillatorField>(def);
}

OscillatorMotion oscillator_exact(const OscillatorDef& d, double t) {
  const double g = d.damping / (2 * d.mass), w2 = d.stiffness / d.mass - g * g, w = std::sqrt(std::abs(w2));
  const double x0 = d.position, b = d.velocity + g * x0;
  // exp(-g t) times cosine and sine of w t (over w), or their hyperbolic kin, which alone may overflow.
  const double decay = trig::exp(-g * t);
  double c = decay, s = decay * t;
  if (w * t > 1e-9 && w2 > 0) {
    const auto sc = trig::sincos(w * t);
    c = decay * sc.cos, s = decay * sc.sin / w;
  } else if (w * t > 1e-9) {
    const double slow = trig::exp(-d.stiffness / d.mass / (g + w) * t), fast = trig::exp(-(g + w) * t);
    c = 0.5 * (slow + fast), s = 0.5 * (slow - fast) / w;
  }
  const double x = x0 * c + b * s;
  return {x, b * c - w2 * x0 * s - g * x};
}

}  // namespace truestep::oscillator
