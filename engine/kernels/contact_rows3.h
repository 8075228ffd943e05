// Contacts of rigid bodies, as many side by side as lanes: rows J v >= 0 solved by sequential impulses within
// a manifold of up to four points, for the substeps of a soft step (Catto, "Solver2D", 2024).
//
// Bodies are in scaled variables in which every mass matrix is the identity: the record of body i is
//   (sqrt(m) v, sqrt(I) R^T w),     I the principal moments, R the orientation,
// and likewise for displacements, so that one vector j = S (r x n), S = I^-1/2 R^T, both reads and changes a
// turn. Turns are in the body's frame, where inertia stays what it is while the body moves:
//   J v = n . (v_b / sqrt(m_b) - v_a / sqrt(m_a)) + j_b . w_b - j_a . w_a,    K = 1/m_a + 1/m_b + j_a^2 +
//   j_b^2
// Friction acts at the points' centre of pressure: a vector in the tangent plane, clipped to the disc of
// radius mu sum(l), and a twist about the normal of at most mu sum(l_p |p - c|), which is what the points
// give when the body only spins. Rolling resistance is a vector of torques along the plane.
// Lanes that hold nothing have inverse K and impulses 0 and name the record `end`, which is never written.
#pragma once
#include "engine/kernels/row_math3.h"

namespace truestep {

/// Numbers of one substep's pass.
template <class T>
struct ContactPass {
  T inverse_h;      ///< 1/s
  T elapsed;        ///< s since the step's start, for surfaces that move by themselves
  T bias_rate;      ///< 1/s, share of a depth that is taken back
  T mass_scale;     ///< 1
  T impulse_scale;  ///< 1
  T push_out;       ///< m/s, fastest taking back
};

template <class T>
struct alignas(64) ContactGroup {
  using W = Wide<T>;
  static constexpr int kPoints = 4;

  uint32_t a[W::kLanes], b[W::kLanes];  ///< records, `end` for bodies that contacts do not move
  int points = 0;                       ///< most points of a lane
  enum : uint32_t { kBounces = 1, kRolls = 2, kDrifts = 4 };
  uint32_t flags = 0;

  W normal[3], tangent[2][3], root_a, root_b;  ///< axes; 1/sqrt(m)
  // The patch: what a and b do to one another at the centre of pressure c, as force and torque.
  W cja[3], cjb[3], tja[2][3], tjb[2][3];  ///< rows along the normal and the tangents at c
  W nja[3], njb[3], rja[2][3], rjb[2][3];  ///< turns about the normal and the tangents
  W inverse[21];                           ///< of K over these six rows, lower triangle by rows
  W whole, filled;                         ///< 1 where the points span a plane; where there are any
  struct Place {
    W x, y;               ///< m from c along the tangents
    W share[3];           ///< of force, torques about the tangents that this point takes
    W spare, per_spare;   ///< what four points may add without force or torque; 1 / spare
    W separation, apart;  ///< m, at the step's start and now
    W impulse, drift;
  } place[kPoints];
  W friction, slide[2], slide_drift[2];  ///< coefficient, impulses, velocity of the surfaces themselves
  W twist, twist_drift, lever[kPoints];
  // Rows one by one, for lanes whose patch lets go or slides.
  struct Point {
    W ja[3], jb[3], inverse_k;
  } point[kPoints];
  W k_inverse[3], twist_k;  ///< of friction: xx, xy, yy
  // Read only where the flags ask for it.
  W restitution;
  W roll_k[3], roll[2], rolling;
};

/// One manifold per lane, as the narrow phase found it.
template <class T>
struct ContactLanes {
  using W = Wide<T>;
  W normal[3], arm[4][3], apart[3];  ///< points from a's centre; b's centre from a's
  W active[4], separation[4], impulse[4];
  W root_a, root_b, turn_a[9], turn_b[9];  ///< 1/sqrt(m); S by rows
  W friction, spinning, rolling, restitution;
  W slide[3], twist, roll[3];  ///< impulses of the last step in the world
  W surface[3],
      surface_turn[3];  ///< velocity at a's centre and spin of b's surface against a's by themselves
};

/// Rows of a group from what the narrow phase found; g.a, g.b, g.points and g.flags are set by the caller.
template <class T>
void prepare_contacts(ContactGroup<T>& g, const ContactLanes<T>& in) {
  using W = Wide<T>;
  namespace r = contact_rows;
  const W zero(0), one(1);
  for (int k = 0; k < 3; ++k) g.normal[k] = in.normal[k];
  r::basis(in.normal, g.tangent);
  g.root_a = in.root_a, g.root_b = in.root_b;
  const W linear = in.root_a * in.root_a + in.root_b * in.root_b;
  const auto inverse = [&](const W& k) { return where_positive(k, one / k, zero); };
  const auto row = [&](const W arm[3], const W axis[3], W ja[3], W jb[3]) {
    W other[3], moment[3];
    r::cross(arm, axis, moment), r::apply(in.turn_a, moment, ja);
    for (int k = 0; k < 3; ++k) other[k] = arm[k] - in.apart[k];
    r::cross(other, axis, moment), r::apply(in.turn_b, moment, jb);
  };
  const auto drift = [&](const W arm[3], const W axis[3]) {
    W v[3];
    r::cross(in.surface_turn, arm, v);
    for (int k = 0; k < 3; ++k) v[k] += in.surface[k];
    return r::dot(v, axis);
  };
  const bool drifts = g.flags & ContactGroup<T>::kDrifts;

  W weight(0), center[3] = {}, half(0);
  for (int p = 0; p < g.points; ++p) {
    auto& q = g.point[p];
    auto& at = g.place[p];
    row(in.arm[p], in.normal, q.ja, q.jb);
    q.inverse_k = in.active[p] * inverse(linear + r::dot(q.ja, q.ja) + r::dot(q.jb, q.jb));
    at.separation = at.apart = in.separation[p], at.impulse = in.impulse[p];
    at.drift = drifts ? drift(in.arm[p], in.normal) : zero;
    // Points share the pressure of the last step; all alike where there was none.
    const W w = madd(in.active[p], W(1e-12), in.impulse[p]);
    weight += w;
    r::add(center, w, in.arm[p]);
    half = madd(w, W(T(0.5)) * max(in.separation[p], zero), half);
  }
  const W share = inverse(weight);
  for (W& c : center) c *= share;

  row(center, in.normal, g.cja, g.cjb);
  // Friction acts where the surfaces will meet, not between them.
  half *= share;
  W from_a[3], from_b[3];
  for (int k = 0; k < 3; ++k) {
    from_a[k] = nmadd(half, in.normal[k], center[k]);
    from_b[k] = madd(half, in.normal[k], center[k] - in.apart[k]);
  }
  for (int t = 0; t < 2; ++t) {
    W moment[3];
    r::cross(from_a, g.tangent[t], moment), r::apply(in.turn_a, moment, g.tja[t]);
    r::cross(from_b, g.tangent[t], moment), r::apply(in.turn_b, moment, g.tjb[t]);
    r::apply(in.turn_a, g.tangent[t], g.rja[t]), r::apply(in.turn_b, g.tangent[t], g.rjb[t]);
  }
  r::apply(in.turn_a, in.normal, g.nja), r::apply(in.turn_b, in.normal, g.njb);

  // Rows (1, y, -x) of the points: how their impulses make force and torque, and least squares back.
  W n(0), sx(0), sy(0), sxx(0), sxy(0), syy(0);
  for (int p = 0; p < g.points; ++p) {
    W d[3];
    for (int k = 0; k < 3; ++k) d[k] = (in.arm[p][k] - center[k]) * in.active[p];
    const W x = r::dot(d, g.tangent[0]), y = r::dot(d, g.tangent[1]);
    g.place[p].x = x, g.place[p].y = y;
    n += in.active[p], sx += x, sy += y;
    sxx = madd(x, x, sxx), sxy = madd(x, y, sxy), syy = madd(y, y, syy);
    g.lever[p] = madd(in.friction, sqrt(r::dot(d, d)), in.spinning) * in.active[p];
  }
  const W c00 = syy * sxx - sxy * sxy, c01 = sy * sxx - sx * sxy, c02 = sy * sxy - sx * syy;
  const W det = n * c00 - sy * c01 + sx * c02, scale = sxx + syy;
  // A patch thinner than a hundredth of its length is an edge.
  g.whole = where_positive(det - W(1e-4) * n * scale * scale, one, zero);
  const W inv = g.whole / where_positive(det, det, one);
  const W c11 = n * sxx - sx * sx, c12 = n * sxy - sx * sy, c22 = n * syy - sy * sy;
  for (int p = 0; p < g.points; ++p) {
    auto& at = g.place[p];
    const W f = inv * in.active[p], x = -at.x;
    at.share[0] = f * (c00 - c01 * at.y - c02 * x);
    at.share[1] = f * (c11 * at.y + c12 * x - c01);
    at.share[2] = f * (c12 * at.y + c22 * x - c02);
  }
  r::spare_impulses(g.place, g.points, in.active[3] * g.whole);
  {
    const W* ja[6] = {g.cja, g.tja[0], g.tja[1], g.nja, g.rja[0], g.rja[1]};
    const W* jb[6] = {g.cjb, g.tjb[0], g.tjb[1], g.njb, g.rjb[0], g.rjb[1]};
    W k[6][6];
    for (int p = 0; p < 6; ++p) {
      for (int q = 0; q <= p; ++q) k[p][q] = r::dot(ja[p], ja[q]) + r::dot(jb[p], jb[q]);
      if (p < 3) k[p][p] += linear;
      k[p][p] = madd(k[p][p], W(1e-5), k[p][p]);
    }
    r::invert_positive<6>(k, g.inverse);
    r::invert(k[1][1], k[2][1], k[2][2], g.k_inverse);
    g.twist_k = in.active[0] * inverse(k[3][3]);
    if (g.flags & ContactGroup<T>::kRolls) r::invert(k[4][4], k[5][4], k[5][5], g.roll_k);
  }
  for (W& k : g.k_inverse) k *= in.active[0];
  g.friction = in.friction;
  for (int t = 0; t < 2; ++t) {
    g.slide[t] = r::dot(in.slide, g.tangent[t]);
    g.slide_drift[t] = drifts ? drift(center, g.tangent[t]) : zero;
  }
  g.twist = in.twist, g.twist_drift = drifts ? r::dot(in.surface_turn, in.normal) : zero;
  g.filled = in.active[0];
  g.restitution = in.restitution, g.rolling = in.rolling;
  if (g.flags & ContactGroup<T>::kRolls) {
    for (int t = 0; t < 2; ++t) g.roll[t] = r::dot(in.roll, g.tangent[t]);
    for (W& k : g.roll_k) k *= in.active[0];
  }
}

}  // namespace truestep
