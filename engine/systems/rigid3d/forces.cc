#include "engine/systems/rigid3d/forces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/kernels/rigid/free_rotation.h"
#include "engine/math/solvers/small_lu.h"

namespace truestep::rigid3d {

namespace {

// Constant forces and torques of the scene's bodies. Those that turn with the body have the direction at
// mid-step.
void add_constant(const State& s, std::span<const BodyKind> kinds, double h, std::vector<Vec3>& change,
                  std::vector<Vec3>& twist) {
  const auto kind = s.span<uint32_t>(columns::kind);
  const double *q = s.f64(columns::orientation).data(), *w = s.f64(columns::angular_velocity).data();
  for (size_t i = 0; i < kind.size(); ++i) {
    const BodyKind& k = kinds[kind[i]];
    if (!k.forced()) continue;
    Vec3 force = k.force, torque = k.torque;
    if (k.force_turns) {
      const Rotation middle =
          rotation(normalized(free_rotation::turn(load3(w, i) * (0.5 * h)) * load_quat(q, i)));
      force = middle.apply(force), torque = middle.apply(torque);
    }
    change[i] += force * (h / k.mass);
    if (norm2(torque) == 0) continue;
    if (twist.empty()) twist.resize(kind.size());
    twist[i] = torque * h;
  }
}

// Response of a point of a body to an impulse there: K J = J / m + (I^-1 (arm x J)) x arm.
struct PointMass {
  const BodyKind& body;
  Quat q;
  Vec3 arm;
  Vec3 answer(const Vec3& impulse) const {
    return impulse / body.mass +
           cross(free_rotation::spin_of(q, cross(arm, impulse), body.resistance()), arm);
  }
};

// Impulse (N s) of a spring from a point to its target, critically damped for the mass, implicit in both:
// (1 + (h c + h^2 k) K) J = -h (k away + (c + h k) speed).
Vec3 pull(double k, double h, const Vec3& away, const Vec3& speed, const PointMass& point) {
  const double c = 2 * std::sqrt(k * point.body.mass), share = h * c + h * h * k;
  const Vec3 wanted = (away * k + speed * (c + h * k)) * -h;
  const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  SmallLu<double, 3> lu;
  for (int j = 0; j < 3; ++j) {
    const Vec3 column = axes[j] + share * point.answer(axes[j]);
    lu.matrix()[3 * j] = column.x, lu.matrix()[3 * j + 1] = column.y, lu.matrix()[3 * j + 2] = column.z;
  }
  std::array<double, 3> out{wanted.x, wanted.y, wanted.z};
  lu.factor();
  lu.solve(out.data());
  return {out[0], out[1], out[2]};
}

}  // namespace

void collect_forces(State& s, std::span<const BodyKind> kinds, double h, std::vector<Vec3>& change,
                    std::vector<Vec3>& twist) {
  const auto kind = s.span<uint32_t>(columns::kind);
  const Vec3 gravity = load3(s.f64(columns::gravity).data(), 0);
  change.resize(kind.size());
  for (size_t i = 0; i < kind.size(); ++i) change[i] = gravity * (kinds[kind[i]].gravity_scale * h);
  twist.clear();
  const auto forced = [](const BodyKind& k) { return k.forced(); };
  if (std::any_of(kinds.begin(), kinds.end(), forced)) add_constant(s, kinds, h, change, twist);
  const double *x = s.f64(columns::position).data(), *v = s.f64(columns::velocity).data(),
               *w = s.f64(columns::angular_velocity).data();
  const double* q = s.f64(columns::orientation).data();
  const auto add = [&](size_t i, const Vec3& impulse, const Vec3& arm) {
    change[i] += impulse / kinds[kind[i]].mass;
    if (norm2(arm) == 0) return;
    if (twist.empty()) twist.resize(kind.size());
    twist[i] += cross(arm, impulse);
  };
  for (size_t k = 0; k < columns::kHands.pushes(s); ++k) {
    const UserForces::Push p = columns::kHands.push(s, k);
    const auto row = row_of_body(s, p.who);
    if (!row || !(kinds[kind[*row]].mass > 0)) continue;
    add(*row, p.force * h, rotation(load_quat(q, *row)).apply(p.at));
    wake_body(s, *row, kinds);
  }
  columns::kHands.count_down(s, h);
  for (size_t k = 0; k < columns::kHands.drags(s); ++k) {
    const UserForces::Drag d = columns::kHands.drag(s, k);
    const auto row = row_of_body(s, d.who);
    if (!row) continue;
    const BodyKind& b = kinds[kind[*row]];
    if (!(b.mass > 0)) continue;
    wake_body(s, *row, kinds);
    const Vec3 arm = rotation(load_quat(q, *row)).apply(d.at);
    const Vec3 away = load3(x, *row) + arm - d.target;
    const Vec3 speed = load3(v, *row) + cross(load3(w, *row), arm);
    add(*row, pull(d.stiffness, h, away, speed, PointMass{b, load_quat(q, *row), arm}), arm);
  }
}

}  // namespace truestep::rigid3d
