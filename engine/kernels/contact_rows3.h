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
#include "engine/math/wide.h"

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
    W x, y;              ///< m from c along the tangents
    W share[3];          ///< of force, torques about the tangents that this point takes
    W spare, per_spare;  ///< what four points may add without force or torque; 1 / spare
    W separation, impulse, drift;
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

namespace contact_rows {

template <class W>
W dot(const W a[3], const W b[3]) {
  return madd(a[2], b[2], madd(a[1], b[1], a[0] * b[0]));
}
template <class W>
void cross(const W a[3], const W b[3], W out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1], out[1] = a[2] * b[0] - a[0] * b[2], out[2] = a[0] * b[1] - a[1] * b[0];
}
/// S a for S by rows.
template <class W>
void apply(const W s[9], const W a[3], W out[3]) {
  for (int k = 0; k < 3; ++k) out[k] = madd(s[3 * k + 2], a[2], madd(s[3 * k + 1], a[1], s[3 * k] * a[0]));
}
/// S^T a.
template <class W>
void apply_transposed(const W s[9], const W a[3], W out[3]) {
  for (int k = 0; k < 3; ++k) out[k] = madd(s[6 + k], a[2], madd(s[3 + k], a[1], s[k] * a[0]));
}
/// v += s j.
template <class W>
void add(W v[3], const W& s, const W j[3]) {
  for (int k = 0; k < 3; ++k) v[k] = madd(s, j[k], v[k]);
}
template <class W>
void subtract(W v[3], const W& s, const W j[3]) {
  for (int k = 0; k < 3; ++k) v[k] = nmadd(s, j[k], v[k]);
}
/// Two unit vectors across n (Duff et al. 2017, "Building an orthonormal basis, revisited").
template <class W>
void basis(const W n[3], W t[2][3]) {
  const W one(1), sign = where_positive(n[2], one, -one), a = -one / (sign + n[2]), b = n[0] * n[1] * a;
  t[0][0] = one + sign * n[0] * n[0] * a, t[0][1] = sign * b, t[0][2] = -sign * n[0];
  t[1][0] = b, t[1][1] = sign + n[1] * n[1] * a, t[1][2] = -n[1];
}
/// Inverse of ((xx, xy), (xy, yy)), zero where it is singular.
template <class W>
void invert(const W& xx, const W& xy, const W& yy, W out[3]) {
  const W det = xx * yy - xy * xy, inv = where_positive(det, W(1) / det, W(0));
  out[0] = yy * inv, out[1] = -xy * inv, out[2] = xx * inv;
}
/// Four points in a plane hold a body in one way too many: adding s (a1, a2, a3, a4) with sum(a) = 0 and
/// sum(a p) = 0 changes neither force nor torque. Zero in lanes where `four` is.
template <class Place, class W>
void spare_impulses(Place place[4], int points, const W& four) {
  for (int p = 0; p < points; ++p) place[p].spare = place[p].per_spare = W(0);
  if (points < 4) return;
  const auto area = [&](int i, int j, int k) {
    return (place[j].x - place[i].x) * (place[k].y - place[i].y) -
           (place[j].y - place[i].y) * (place[k].x - place[i].x);
  };
  const W a[4] = {area(1, 2, 3), -area(0, 2, 3), area(0, 1, 3), -area(0, 1, 2)};
  W largest(0);
  for (const W& x : a) largest = max(largest, max(x, -x));
  const W scale = four / where_positive(largest, largest, W(1));
  for (int p = 0; p < 4; ++p) {
    const W x = a[p] * scale;
    place[p].spare = x;
    place[p].per_spare = where_positive(max(x, -x) - W(1e-3), W(1) / x, W(0));
  }
}
/// Inverse of a symmetric positive matrix, lower triangles by rows.
template <int n, class W>
void invert_positive(const W k[n][n], W out[n * (n + 1) / 2]) {
  W l[n][n], m[n][n];
  for (int p = 0; p < n; ++p) {
    for (int q = 0; q <= p; ++q) {
      W sum = k[p][q];
      for (int e = 0; e < q; ++e) sum = nmadd(l[p][e], l[q][e], sum);
      l[p][q] = p == q ? sqrt(max(sum, W(1e-30))) : sum * m[q][q];
    }
    m[p][p] = W(1) / l[p][p];
  }
  for (int p = 0; p < n; ++p) {
    for (int q = 0; q < p; ++q) {
      W sum(0);
      for (int e = q; e < p; ++e) sum = nmadd(l[p][e], m[e][q], sum);
      m[p][q] = sum * m[p][p];
    }
  }
  for (int p = 0, at = 0; p < n; ++p) {
    for (int q = 0; q <= p; ++q, ++at) {
      W sum(0);
      for (int e = p; e < n; ++e) sum = madd(m[e][p], m[e][q], sum);
      out[at] = sum;
    }
  }
}
/// Two more impulses on top of `total`, clipped to the disc of radius `limit`; what was added.
template <class W>
void clip(W total[2], const W d[2], const W& limit, W added[2]) {
  const W x = total[0] + d[0], y = total[1] + d[1], length = sqrt(madd(y, y, x * x));
  const W share = where_positive(length - limit, limit / length, W(1));
  const W cx = x * share, cy = y * share;
  added[0] = cx - total[0], added[1] = cy - total[1];
  total[0] = cx, total[1] = cy;
}

}  // namespace contact_rows

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
    at.separation = in.separation[p], at.impulse = in.impulse[p];
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

/// Adds every impulse of the group to the records (scaled velocities).
template <class T>
void apply_contacts(const ContactGroup<T>& g, Record8<T>* records, uint32_t end) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W a[6], b[6], sum(0);
  gather6(records, g.a, a), gather6(records, g.b, b);
  for (int p = 0; p < g.points; ++p) {
    const auto& q = g.point[p];
    const W& l = g.place[p].impulse;
    sum += l;
    r::subtract(a + 3, l, q.ja), r::add(b + 3, l, q.jb);
  }
  r::subtract(a, sum * g.root_a, g.normal), r::add(b, sum * g.root_b, g.normal);
  for (int t = 0; t < 2; ++t) {
    r::subtract(a, g.slide[t] * g.root_a, g.tangent[t]), r::add(b, g.slide[t] * g.root_b, g.tangent[t]);
    r::subtract(a + 3, g.slide[t], g.tja[t]), r::add(b + 3, g.slide[t], g.tjb[t]);
  }
  r::subtract(a + 3, g.twist, g.nja), r::add(b + 3, g.twist, g.njb);
  if (g.flags & ContactGroup<T>::kRolls) {
    for (int t = 0; t < 2; ++t) {
      r::subtract(a + 3, g.roll[t], g.rja[t]), r::add(b + 3, g.roll[t], g.rjb[t]);
    }
  }
  scatter6(records, g.a, end, a), scatter6(records, g.b, end, b);
}

enum class ContactSolve : uint8_t {
  push,  ///< depths are taken back
  relax  ///< velocities only: takes out what `push` put in
};

namespace detail {
/// Rolling, twist and slide of a group, for the normal impulses as they are.
template <class T>
void solve_friction(ContactGroup<T>& g, Wide<T> a[6], Wide<T> b[6]) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W pressure(0), torque(0);
  for (int p = 0; p < g.points; ++p) {
    pressure += g.place[p].impulse;
    torque = madd(g.lever[p], g.place[p].impulse, torque);
  }
  if (g.flags & ContactGroup<T>::kRolls) {
    W slip[2], change[2], added[2];
    for (int t = 0; t < 2; ++t) slip[t] = r::dot(g.rjb[t], b + 3) - r::dot(g.rja[t], a + 3);
    change[0] = -madd(g.roll_k[1], slip[1], g.roll_k[0] * slip[0]);
    change[1] = -madd(g.roll_k[2], slip[1], g.roll_k[1] * slip[0]);
    r::clip(g.roll, change, g.rolling * pressure, added);
    for (int t = 0; t < 2; ++t) r::subtract(a + 3, added[t], g.rja[t]), r::add(b + 3, added[t], g.rjb[t]);
  }
  {
    const W speed = r::dot(g.njb, b + 3) - r::dot(g.nja, a + 3) + g.twist_drift;
    const W total = max(min(nmadd(g.twist_k, speed, g.twist), torque), -torque), added = total - g.twist;
    g.twist = total;
    r::subtract(a + 3, added, g.nja), r::add(b + 3, added, g.njb);
  }
  {
    W slip[2], change[2], added[2];
    for (int t = 0; t < 2; ++t) {
      slip[t] = g.root_b * r::dot(g.tangent[t], b) - g.root_a * r::dot(g.tangent[t], a) +
                (r::dot(g.tjb[t], b + 3) - r::dot(g.tja[t], a + 3)) + g.slide_drift[t];
    }
    change[0] = -madd(g.k_inverse[1], slip[1], g.k_inverse[0] * slip[0]);
    change[1] = -madd(g.k_inverse[2], slip[1], g.k_inverse[1] * slip[0]);
    r::clip(g.slide, change, g.friction * pressure, added);
    for (int t = 0; t < 2; ++t) {
      r::subtract(a, added[t] * g.root_a, g.tangent[t]), r::add(b, added[t] * g.root_b, g.tangent[t]);
      r::subtract(a + 3, added[t], g.tja[t]), r::add(b + 3, added[t], g.tjb[t]);
    }
  }
}
}  // namespace detail

namespace detail {
/// What every point should have for a relative velocity, negated; what is apart may close in one substep.
template <ContactSolve kind, class T>
Wide<T> wanted(const Wide<T>& s, const ContactPass<T>& pass) {
  using W = Wide<T>;
  if constexpr (kind == ContactSolve::push) {
    return where_positive(s, s * W(pass.inverse_h), max(s * W(pass.bias_rate), W(-pass.push_out)));
  }
  return max(s, W(0)) * W(pass.inverse_h);
}

/// 0 where a relaxation has to leave a point alone, 1 elsewhere: what bounces is not slowed before it hits.
template <class T>
Wide<T> held_back(const ContactGroup<T>& g, int p, const Wide<T>& separation) {
  const Wide<T> zero(0), one(1);
  const Wide<T> waits = where_positive(separation, where_positive(g.place[p].impulse, one, zero), one);
  return where_positive(g.restitution, waits, one);
}

/// All six ways in which a patch holds at once. Lanes where that would pull, slide or twist are left as they
/// are: 1 in `done` for the others.
template <ContactSolve kind, class T>
Wide<T> solve_patch(ContactGroup<T>& g, Wide<T> a[6], Wide<T> b[6], const Wide<T> separation[4],
                    const ContactPass<T>& pass) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W slip[6], f[6] = {};
  slip[0] = g.root_b * r::dot(g.normal, b) - g.root_a * r::dot(g.normal, a) +
            (r::dot(g.cjb, b + 3) - r::dot(g.cja, a + 3));
  for (int t = 0; t < 2; ++t) {
    slip[1 + t] = g.root_b * r::dot(g.tangent[t], b) - g.root_a * r::dot(g.tangent[t], a) +
                  (r::dot(g.tjb[t], b + 3) - r::dot(g.tja[t], a + 3)) + g.slide_drift[t];
    slip[4 + t] = r::dot(g.rjb[t], b + 3) - r::dot(g.rja[t], a + 3);
  }
  slip[3] = r::dot(g.njb, b + 3) - r::dot(g.nja, a + 3) + g.twist_drift;
  W held[3] = {}, before(0);  // force and torques of the normal impulses
  for (int p = 0; p < g.points; ++p) {
    const auto& at = g.place[p];
    const W u = wanted<kind>(separation[p], pass) + at.drift;
    slip[0] = madd(at.share[0], u, slip[0]);
    slip[4] = madd(at.share[1], u, slip[4]), slip[5] = madd(at.share[2], u, slip[5]);
    held[0] += at.impulse;
    held[1] = madd(at.y, at.impulse, held[1]), held[2] = nmadd(at.x, at.impulse, held[2]);
  }
  for (int p = 0, at = 0; p < 6; ++p) {
    for (int q = 0; q < p; ++q, ++at) {
      f[p] = nmadd(g.inverse[at], slip[q], f[p]);
      f[q] = nmadd(g.inverse[at], slip[p], f[q]);
    }
    f[p] = nmadd(g.inverse[at], slip[p], f[p]), ++at;
  }
  if constexpr (kind == ContactSolve::push) {
    const int normal_rows[3] = {0, 4, 5};
    for (int e = 0; e < 3; ++e) {
      const int p = normal_rows[e];
      f[p] = W(pass.mass_scale) * f[p] - W(pass.impulse_scale) * held[e];
    }
  }
  // The force and torques that the points have to make, spread as evenly as can be without pulling.
  const W zero(0), one(1);
  W impulse[4], low(-1e30), high(1e30);
  before = held[0];
  for (int k = 0; k < 3; ++k) held[k] += f[k == 0 ? 0 : 3 + k];
  for (int p = 0; p < g.points; ++p) {
    const auto& at = g.place[p];
    impulse[p] = madd(at.share[2], held[2], madd(at.share[1], held[1], at.share[0] * held[0]));
    const W zeroed = -impulse[p] * at.per_spare;
    low = where_positive(at.per_spare, max(low, zeroed), low);
    high = where_positive(-at.per_spare, min(high, zeroed), high);
  }
  const W moved = min(max(zero, low), high);
  W least(1e30), pressure(0), torque(0);
  for (int p = 0; p < g.points; ++p) {
    const auto& at = g.place[p];
    impulse[p] = madd(moved, at.spare, impulse[p]);
    least = min(least, impulse[p]);
    impulse[p] = max(impulse[p], zero);
    pressure += impulse[p];
    torque = madd(g.lever[p], impulse[p], torque);
  }
  const W slide[2] = {g.slide[0] + f[1], g.slide[1] + f[2]}, twist = g.twist + f[3];
  // A push takes from the points what friction may still rely on.
  const W limit = g.friction * max(pressure, before);
  W done = where_positive(-least - W(1e-5) * pressure, zero, g.whole);
  if (kind == ContactSolve::relax && (g.flags & ContactGroup<T>::kBounces)) {
    for (int p = 0; p < g.points; ++p) {
      done = where_positive(g.point[p].inverse_k, done * held_back(g, p, separation[p]), done);
    }
  }
  done = where_positive(madd(slide[1], slide[1], slide[0] * slide[0]) - limit * limit, zero, done);
  done = where_positive(max(twist, -twist) - torque, zero, done);
  for (int p = 0; p < g.points; ++p) {
    g.place[p].impulse = where_positive(done, impulse[p], g.place[p].impulse);
  }
  for (int t = 0; t < 2; ++t) g.slide[t] = where_positive(done, slide[t], g.slide[t]);
  g.twist = where_positive(done, twist, g.twist);
  for (W& x : f) x = where_positive(done, x, zero);
  W push[3];
  for (int k = 0; k < 3; ++k) {
    push[k] = madd(f[2], g.tangent[1][k], madd(f[1], g.tangent[0][k], f[0] * g.normal[k]));
  }
  r::subtract(a, g.root_a, push), r::add(b, g.root_b, push);
  const W* ja[6] = {g.cja, g.tja[0], g.tja[1], g.nja, g.rja[0], g.rja[1]};
  const W* jb[6] = {g.cjb, g.tjb[0], g.tjb[1], g.njb, g.rjb[0], g.rjb[1]};
  for (int k = 0; k < 6; ++k) r::subtract(a + 3, f[k], ja[k]), r::add(b + 3, f[k], jb[k]);
  return done;
}

/// The points' normal impulses one after the other.
template <ContactSolve kind, class T>
void solve_points(ContactGroup<T>& g, Wide<T> a[6], Wide<T> b[6], const Wide<T> separation[4],
                  const ContactPass<T>& pass) {
  using W = Wide<T>;
  namespace r = contact_rows;
  // The linear part of J v changes by the same number for all points.
  const W k = g.root_a * g.root_a + g.root_b * g.root_b, zero(0), one(1);
  W linear = g.root_b * r::dot(g.normal, b) - g.root_a * r::dot(g.normal, a), sum(0);
  for (int p = 0; p < g.points; ++p) {
    auto& q = g.point[p];
    auto& at = g.place[p];
    const W speed = linear + (r::dot(q.jb, b + 3) - r::dot(q.ja, a + 3)) + at.drift;
    const W& s = separation[p];
    W total;
    if constexpr (kind == ContactSolve::push) {
      const W mass = where_positive(s, one, W(pass.mass_scale));
      const W leak = where_positive(s, zero, W(pass.impulse_scale));
      total = at.impulse - q.inverse_k * mass * (speed + wanted<kind>(s, pass)) - leak * at.impulse;
    } else {
      total = nmadd(q.inverse_k, speed + wanted<kind>(s, pass), at.impulse);
      total = total * held_back(g, p, s);
    }
    total = max(total, zero);
    const W added = total - at.impulse;
    at.impulse = total;
    sum += added;
    linear = madd(k, added, linear);
    r::subtract(a + 3, added, q.ja), r::add(b + 3, added, q.jb);
  }
  r::subtract(a, sum * g.root_a, g.normal), r::add(b, sum * g.root_b, g.normal);
}
}  // namespace detail

/// How far apart (m) the points of a group are after the displacements `d`, `elapsed` s into the step.
template <class T>
void separations(const ContactGroup<T>& g, const Record8<T>* d, T elapsed, Wide<T> out[4]) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W da[6], db[6], turn[2];
  gather6(d, g.a, da), gather6(d, g.b, db);
  const W moved = g.root_b * r::dot(g.normal, db) - g.root_a * r::dot(g.normal, da) +
                  (r::dot(g.cjb, db + 3) - r::dot(g.cja, da + 3));
  for (int t = 0; t < 2; ++t) turn[t] = r::dot(g.rjb[t], db + 3) - r::dot(g.rja[t], da + 3);
  for (int p = 0; p < g.points; ++p) {
    const auto& at = g.place[p];
    out[p] = madd(at.drift, W(elapsed), at.separation) + nmadd(at.x, turn[1], madd(at.y, turn[0], moved));
  }
}

/// One pass over a group: patches that hold at once, then the rows of those that do not.
template <ContactSolve kind, class T>
void solve_contacts(ContactGroup<T>& g, Record8<T>* v, const Record8<T>* d, uint32_t end,
                    const ContactPass<T>& pass) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W a[6], b[6], separation[4];
  separations(g, d, pass.elapsed, separation);
  gather6(v, g.a, a), gather6(v, g.b, b);
  bool rest = true;
  if (g.points > 2 && !(g.flags & ContactGroup<T>::kRolls)) {
    const W done = detail::solve_patch<kind>(g, a, b, separation, pass);
    rest = any_below(done, g.filled);
    // A push gives up some of the normal impulses; without friction's word on that, bodies creep.
    if (kind == ContactSolve::push && !rest) detail::solve_friction(g, a, b);
  }
  if (rest) {
    // Friction is bounded by the normal impulses of the last relaxation, never by what a push leaves.
    if constexpr (kind == ContactSolve::push) detail::solve_friction(g, a, b);
    detail::solve_points<kind>(g, a, b, separation, pass);
    if constexpr (kind == ContactSolve::relax) detail::solve_friction(g, a, b);
  }
  scatter6(v, g.a, end, a), scatter6(v, g.b, end, b);
}

}  // namespace truestep
