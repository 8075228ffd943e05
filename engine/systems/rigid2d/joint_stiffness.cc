// Springs of joints given by frequency: the stiffness that gives the joint's two bodies this frequency in
// their pose at t = 0,  k = m_eff (2 pi f)^2,  c = 2 zeta m_eff 2 pi f. It stays constant while the bodies
// turn: with a stiffness that followed the effective mass, the spring would have no energy to conserve.
#include "engine/math/trig.h"
#include "engine/systems/rigid2d/model.h"

namespace truestep::rigid2d {
namespace {

Rotation turned(double angle) {
  const trig::SinCos t = trig::sincos(angle);
  return {t.cos, t.sin};
}

/// Speed along the spring per unit impulse, 1/kg or 1/(kg m^2).
double spring_mobility(const Joint& j, const Body& a, const Body& b) {
  if (j.kind == JointKind::revolute || j.kind == JointKind::weld) {
    return a.inverse_inertia + b.inverse_inertia;
  }
  const Rotation qa = turned(a.angle), qb = turned(b.angle);
  const Vec2 rb = qb * j.local_b, across = b.position + rb - a.position, gap = across - qa * j.local_a;
  const Vec2 u = j.kind == JointKind::distance ? flat::unit(gap, {1, 0}) : qa * j.axis;
  const double sa = flat::cross(across, u), sb = flat::cross(rb, u);
  return a.inverse_mass + b.inverse_mass + a.inverse_inertia * sa * sa + b.inverse_inertia * sb * sb;
}

}  // namespace

void stiffen_by_frequency(Joint& j, const Body& a, const Body& b) {
  constexpr double kTurn = 6.283185307179586;
  if (!j.has_spring || !(j.hertz > 0)) return;
  const double w = kTurn * j.hertz, k = spring_mobility(j, a, b), mass = k > 0 ? 1 / k : 0;
  j.stiffness = mass * w * w, j.damping = 2 * j.damping_ratio * mass * w;
}

}  // namespace truestep::rigid2d
