// Forces of contacts on the bodies of a rigid2d state. The state holds the impulses of the last substep;
// the directions of normals are computed again from the poses, after the step: they differ from those that
// the solver used by the rotation in a step.
#include <algorithm>

#include "engine/collision/flat/contact.h"
#include "engine/systems/rigid2d/rigid2d.h"

namespace truestep::rigid2d {

void Rigid2d::contact_forces(const State& s, ShownRows bodies, double* out) const {
  std::fill_n(out, 3 * bodies.count, 0.0);
  const auto keys = s.span<uint64_t>(columns::contact_key);
  const auto impulse = s.span<float>(columns::contact_impulse);
  const double h = settings_for(dt_, substeps(s)).h;
  flat::Contact seen;
  for (size_t k = 0; k < keys.size(); ++k) {
    const float* p = impulse.data() + 5 * k;
    if (p[0] == 0 && p[1] == 0) continue;
    const Shape &a = model_.shapes[keys[k] >> 32], &b = model_.shapes[static_cast<uint32_t>(keys[k])];
    const Pose at = pose_of(s, a.body);
    // Bodies that pushed one another in the last substep are at most a body's size apart.
    if (!flat::touch(a.outline, b.outline, at.to(pose_of(s, b.body)), model_.size, seen)) continue;
    // On b: along the normal from a to b, and along the tangent, the normal turned left.
    const Vec2 n = at.q * seen.normal;
    const double pressure = (double(p[0]) + p[1]) / h, friction = (double(p[2]) + p[3]) / h;
    const Vec3 force{pressure * n.x - friction * n.y, pressure * n.y + friction * n.x, 0};
    store3(out, a.body, load3(out, a.body) - force);
    store3(out, b.body, load3(out, b.body) + force);
  }
}

void Rigid2d::contact_loads(const State& s, ShownRows bodies, double* out) const {
  std::fill_n(out, bodies.count, 0.0);
  const auto keys = s.span<uint64_t>(columns::contact_key);
  const auto impulse = s.span<float>(columns::contact_impulse);
  const double h = settings_for(dt_, substeps(s)).h;
  for (size_t k = 0; k < keys.size(); ++k) {
    const double load = (double(impulse[5 * k]) + impulse[5 * k + 1]) / h;
    out[model_.shapes[keys[k] >> 32].body] += load;
    out[model_.shapes[static_cast<uint32_t>(keys[k])].body] += load;
  }
}

}  // namespace truestep::rigid2d
