#include "engine/systems/rigid3d/forces.h"

#include <algorithm>
#include <cmath>

#include "engine/kernels/free_rotation.h"

namespace truestep {

namespace columns = rigid3d_columns;

namespace {

// Constant forces and torques of the scene's bodies. Those that turn have the direction of the step's middle.
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
  const double *x = s.f64(columns::position).data(), *v = s.f64(columns::velocity).data();
  size_t kept = 0;
  for (size_t k = 0; k < s.rows(columns::push_id); ++k) {
    const uint64_t id = s.span<uint64_t>(columns::push_id)[k];
    const auto row = row_of_body(s, id);
    if (!row) continue;
    const double mass = kinds[kind[*row]].mass;
    const Vec3 force = load3(s.f64(columns::push_force).data(), k);
    if (mass > 0) change[*row] += force * (h / mass);
    wake_body(s, *row, kinds);
    const double remaining = s.f64(columns::push_remaining)[k] - h;
    if (remaining < 0.5 * h) continue;  // half a step of tolerance hides rounding
    s.f64(columns::push_remaining)[kept] = remaining;
    s.span<uint64_t>(columns::push_id)[kept] = id;
    store3(s.f64(columns::push_force).data(), kept++, force);
  }
  for (const auto c : {columns::push_id, columns::push_force, columns::push_remaining}) s.resize(c, kept);
  for (size_t k = 0; k < s.rows(columns::drag_id); ++k) {
    const auto row = row_of_body(s, s.span<uint64_t>(columns::drag_id)[k]);
    if (!row) continue;
    const double mass = kinds[kind[*row]].mass;
    if (!(mass > 0)) continue;
    wake_body(s, *row, kinds);
    // A critically damped spring, implicit in both.
    const double w2 = s.f64(columns::drag_stiffness)[k] / mass, c = 2 * std::sqrt(w2);
    const Vec3 away = load3(x, *row) - load3(s.f64(columns::drag_target).data(), k);
    change[*row] -= (away * w2 + load3(v, *row) * (c + h * w2)) * (h / (1 + h * c + h * h * w2));
  }
}

}  // namespace truestep
