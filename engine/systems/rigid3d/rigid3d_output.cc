// The energy of a rigid3d state, and the forces of its contacts on the bodies.
#include <algorithm>
#include <cmath>

#include "engine/kernels/rigid/free_rotation.h"
#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::rigid3d {

std::optional<Energy> Rigid3d::energy(const State& s, double, Workspace&, const ThreadArena&) const {
  const auto kind = s.span<uint32_t>(columns::kind);
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  const double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data();
  const Vec3 g = load3(s.f64(columns::gravity).data(), 0);
  const double pushed = settings_.push_out_speed;
  Energy e;
  bool driven = joints_drive(s) || columns::kHands.any(s);
  for (size_t i = 0; i < kind.size(); ++i) {
    const BodyKind& b = bodies_.kinds[kind[i]];
    const Vec3 u = load3(v, i), spin = load3(w, i);
    driven = driven || b.conveys();
    if (!b.moved_by_forces()) {
      driven = driven || norm2(u) + norm2(spin) > 0;
      continue;
    }
    driven = driven || b.forced();
    const Vec3 L = free_rotation::momentum({load_quat(q, i), spin}, b.moments);
    e.kinetic += 0.5 * b.mass * norm2(u) + 0.5 * dot(L, spin);
    e.potential -= b.mass * b.gravity_scale * dot(g, load3(x, i));
    e.slack += b.mass * (0.5 * pushed * pushed + std::abs(b.gravity_scale) * norm(g) * b.reach);
  }
  e.potential += spring_energy(s);
  e.exchange = driven ? Energy::Exchange::open : Energy::Exchange::closed;
  return e;
}

namespace {
// N s, sum of the normal impulses at the points of contact k.
double normal_impulse(const State& s, size_t k) {
  const double* impulse = s.f64(columns::contact_impulse).data() + 4 * k;
  return impulse[0] + impulse[1] + impulse[2] + impulse[3];
}
}  // namespace

void Rigid3d::contact_forces(const State& s, ShownRows rows, double* out) const {
  std::fill_n(out, 3 * rows.count, 0.0);
  const double h = s.f64(columns::substep)[0];
  if (!(h > 0)) return;
  const auto bodies = s.span<uint32_t>(columns::contact_bodies);
  const double *normal = s.f64(columns::contact_normal).data(),
               *friction = s.f64(columns::contact_friction).data();
  for (size_t k = 0; k < s.rows(columns::contact_bodies); ++k) {
    const Vec3 slide{friction[4 * k], friction[4 * k + 1], friction[4 * k + 2]};
    const Vec3 force = (load3(normal, k) * normal_impulse(s, k) + slide) / h;
    const size_t a = bodies[2 * k], b = bodies[2 * k + 1];
    store3(out, a, load3(out, a) - force);
    store3(out, b, load3(out, b) + force);
  }
}

void Rigid3d::contact_loads(const State& s, ShownRows rows, double* out) const {
  std::fill_n(out, rows.count, 0.0);
  const double h = s.f64(columns::substep)[0];
  if (!(h > 0)) return;
  const auto bodies = s.span<uint32_t>(columns::contact_bodies);
  for (size_t k = 0; k < s.rows(columns::contact_bodies); ++k) {
    const double load = normal_impulse(s, k) / h;
    out[bodies[2 * k]] += load, out[bodies[2 * k + 1]] += load;
  }
}

}  // namespace truestep::rigid3d
