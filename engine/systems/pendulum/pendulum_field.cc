// The equations of pendulum.h, solved in O(n); impulses are the same solve with nothing else acting.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/math/trig.h"
#include "engine/systems/pendulum/pendulum.h"

namespace truestep::pendulum {

using C = PendulumColumns;

namespace {
std::vector<double> each(const std::vector<double>& given, double all, size_t n) {
  return given.empty() ? std::vector<double>(n, all) : given;
}
}  // namespace

PendulumField::PendulumField(const PendulumDef& def, const Vec3& gravity)
    : def_(def),
      length_(each(def.lengths, def.length, static_cast<size_t>(def.links))),
      mass_(each(def.masses, def.mass, static_cast<size_t>(def.links))),
      gravity_(norm(gravity)),
      down_(normalized(gravity, {0, -1, 0})) {
  // The plane contains gravity and the first axis, or the second one if gravity points along the first.
  const Vec3 axis = std::abs(down_.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  right_ = normalized(axis - dot(axis, down_) * down_);
}

State PendulumField::initial_state() const {
  State s;
  const size_t n = links();
  s.add({"position", "rad", Scalar::f64, 1, Role::position}, n);
  s.add({"velocity", "rad/s", Scalar::f64, 1, Role::velocity}, n);
  s.add({"damping", "N s/m"}, 1);
  s.add({"gravity", "m/s^2"}, 1);
  s.add({"push.row", "1", Scalar::u32}, 0);
  s.add({"push.force", "N", Scalar::f64, 3}, 0);
  s.add({"push.remaining", "s"}, 0);
  std::ranges::copy(each(def_.angles, def_.angle, n), s.f64(C::kAngle).begin());
  std::ranges::copy(each(def_.angular_velocities, 0, n), s.f64(C::kAngularVelocity).begin());
  s.f64(C::kDamping)[0] = def_.damping;
  s.f64(C::kGravity)[0] = gravity_;
  return s;
}

Dependence PendulumField::dependence() const {
  return links() > 1 || def_.damping > 0 ? Dependence::position_and_velocity : Dependence::position;
}

PendulumField::Arrays PendulumField::arrays(double* m) const {
  const size_t n = links();
  return {m, m + n, m + 2 * n, m + 3 * n, m + 4 * n, m + 5 * n};
}

// In: sin, cos, and the external accelerations f_i / m_i of the masses (x along the horizontal, y along
// gravity). Out: angular accelerations.
void PendulumField::solve(const Arrays& s, std::span<const double> rates, std::span<double> a) const {
  const size_t n = links();
  const auto along = [&](size_t i, size_t j) { return s.sin[i] * s.sin[j] + s.cos[i] * s.cos[j]; };
  const auto across = [&](size_t i, size_t j) { return s.sin[j] * s.cos[i] - s.cos[j] * s.sin[i]; };
  const auto weight = [&](size_t i) { return 1 / mass_[i]; };
  // Elimination without pivoting: the matrix is positive definite.
  for (size_t i = 0; i < n; ++i) {
    double d = weight(i), r = length_[i] * rates[i] * rates[i] + s.fx[i] * s.sin[i] + s.fy[i] * s.cos[i];
    if (i > 0) {
      r -= s.fx[i - 1] * s.sin[i] + s.fy[i - 1] * s.cos[i];
      const double off = -along(i, i - 1) * weight(i - 1), factor = off / s.diagonal[i - 1];
      d += weight(i - 1) - factor * off;
      r -= factor * s.tension[i - 1];
    }
    s.diagonal[i] = d;
    s.tension[i] = r;
  }
  for (size_t i = n; i-- > 0;) {
    const double next = i + 1 < n ? -along(i, i + 1) * weight(i) * s.tension[i + 1] : 0;
    s.tension[i] = (s.tension[i] - next) / s.diagonal[i];
  }
  for (size_t i = 0; i < n; ++i) {
    double sum = s.fx[i] * s.cos[i] - s.fy[i] * s.sin[i];
    if (i + 1 < n) sum += s.tension[i + 1] * across(i, i + 1) * weight(i);
    if (i > 0) {
      sum -= s.fx[i - 1] * s.cos[i] - s.fy[i - 1] * s.sin[i];
      sum += s.tension[i - 1] * across(i, i - 1) * weight(i - 1);
    }
    a[i] = sum / length_[i];
  }
}

void PendulumField::acceleration(const Phase& at, std::span<double> a, Evaluation& e) const {
  const size_t n = links();
  const Arrays s = arrays(e.workspace.doubles("pendulum", 6 * n).data());
  const double c = at.state.f64(C::kDamping)[0], g = at.state.f64(C::kGravity)[0];
  double vx = 0, vy = 0;
  for (size_t i = 0; i < n; ++i) {
    const auto sc = trig::sincos(at.x[i]);
    s.sin[i] = sc.sin, s.cos[i] = sc.cos;
    vx += length_[i] * at.v[i] * sc.cos;
    vy -= length_[i] * at.v[i] * sc.sin;
    s.fx[i] = -c * vx / mass_[i];
    s.fy[i] = g - c * vy / mass_[i];
  }
  for (size_t k = 0; k < C::kHands.pushes(at.state); ++k) {
    const UserForces::Push push = C::kHands.push(at.state, k);
    const auto f = in_plane(push.force);
    s.fx[push.who] += f[0] / mass_[push.who], s.fy[push.who] += f[1] / mass_[push.who];
  }
  solve(s, at.v, a);
}

std::vector<double> PendulumField::response(std::span<const double> angles, size_t link,
                                            const Vec3& impulse) const {
  // An impulse acts like a force for an instant: no gravity, no centrifugal terms.
  const size_t n = links();
  std::vector<double> memory(6 * n, 0.0), rest(n, 0.0), change(n);
  const Arrays s = arrays(memory.data());
  for (size_t i = 0; i < n; ++i) {
    const auto sc = trig::sincos(angles[i]);
    s.sin[i] = sc.sin, s.cos[i] = sc.cos;
  }
  const auto j = in_plane(impulse);
  s.fx[link] = j[0] / mass_[link], s.fy[link] = j[1] / mass_[link];
  solve(s, rest, change);
  return change;
}

void PendulumField::positions(std::span<const double> angles, double* out) const {
  Vec3 p = def_.anchor;
  store3(out, 0, p);
  for (size_t i = 0; i < angles.size(); ++i) {
    const auto sc = trig::sincos(angles[i]);
    p += length_[i] * (sc.sin * right_ + sc.cos * down_);
    store3(out, i + 1, p);
  }
}

void PendulumField::velocities(std::span<const double> angles, std::span<const double> rates,
                               double* out) const {
  Vec3 v;
  store3(out, 0, v);
  for (size_t i = 0; i < angles.size(); ++i) {
    const auto sc = trig::sincos(angles[i]);
    v += length_[i] * rates[i] * (sc.cos * right_ - sc.sin * down_);
    store3(out, i + 1, v);
  }
}

std::optional<double> PendulumField::potential(const Phase& at, Evaluation&) const {
  double v = 0, depth = 0;
  for (size_t i = 0; i < links(); ++i) {
    depth += length_[i] * trig::cos(at.x[i]);
    v -= mass_[i] * at.state.f64(C::kGravity)[0] * depth;
  }
  return v;
}

double PendulumField::kinetic(const Phase& at, Evaluation&) const {
  double t = 0, vx = 0, vy = 0;
  for (size_t i = 0; i < links(); ++i) {
    const auto sc = trig::sincos(at.x[i]);
    vx += length_[i] * at.v[i] * sc.cos;
    vy -= length_[i] * at.v[i] * sc.sin;
    t += 0.5 * mass_[i] * (vx * vx + vy * vy);
  }
  return t;
}

std::optional<ForceField::Stiffness> PendulumField::stiffness(const State& state) const {
  // Longer chains have no simple bound.
  if (links() > 1) return std::nullopt;
  return Stiffness{std::sqrt(state.f64(C::kGravity)[0] / length_[0]), state.f64(C::kDamping)[0] / mass_[0]};
}

}  // namespace truestep::pendulum
