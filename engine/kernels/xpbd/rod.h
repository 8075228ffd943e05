// The constraints of Cosserat rods (rod_strain.h), each rod solved directly, as Deul, Kugelstadt, Weiler,
// Bender 2018, "Direct position-based solver for stiff rods", do for segments: bending b_j of joint j and
// stretch s_j of link j in the order b_0 s_0 b_1 s_1 ... b_n turn the system of compliance.h
//   (J W J^T + a) l = (-C - alpha~ lambda - gamma (C - C_n)) / (1 + gamma),   a = alpha~ / (1 + gamma)
// into 3 x 3 blocks, each coupled to the two before and the two after it, and one elimination carries forces
// and moments from end to end whatever the stiffness. Rotations are in a frame's own axes, in which the
// inertia of a section is diagonal: with v + s = conj(qa) qb and g = R^T d / l
//   dG = [g] dt + R^T (dx1 - dx0) / l,      dO = ((s + [v]) dtb - (s - [v]) dta) / l.
// Joint 0 connects a frame of the wall to the first link, joint n the last link to another wall frame; at a
// free end the compliance is kIdle. As many rods as there are lanes are solved side by side; they share no
// point and no frame. The geometric stiffness, that is the change of directions under load, is left to the
// next substep as for chains: see q of chain.h.
#pragma once
#include "engine/kernels/xpbd/chain.h"
#include "engine/kernels/xpbd/lane_matrix3.h"

namespace truestep::xpbd {

/// Rods of `links` links side by side: n + 1 points, n + 2 frames, n + 1 joints in every lane, interleaved.
template <class T>
struct Rods {
  size_t links = 0;
  const uint32_t* points = nullptr;     ///< (n + 1) x lanes, rows of positions
  const uint32_t* frames = nullptr;     ///< (n + 2) x lanes, rows of quaternions and of inverse inertias
  const T* base = nullptr;              ///< n x 3 x lanes: x_{j+1} - x_j at which rows of positions are 0
  const T* per_length = nullptr;        ///< n x lanes, 1/m, over the rest length of links
  const T* joint_per_length = nullptr;  ///< (n + 1) x lanes, 1/m
  const T* rest = nullptr;              ///< (n + 1) x 3 x lanes, 1/m: O0
  const T* stretch = nullptr;           ///< n x 3 x lanes: 1 / (stiffness l), 1/J; along d1, d2, d3
  const T* bend = nullptr;              ///< (n + 1) x 3 x lanes, 1/(J m^2)
  const T* inverse_inertia = nullptr;   ///< rows of 4, 1/(kg m^2) about d1, d2, d3; 0: held
  const T* before = nullptr;  ///< (2 n + 1) x 3 x lanes: strains at the substep's start; null: undamped
  T gamma = 0;                ///< damping time over h, 1
  T* lambda = nullptr;        ///< (2 n + 1) x 3 x lanes, added to; null: zero so far, not needed later
};

/// One row of the system: inverse pivot, couplings to the row before and the one before that, right-hand
/// side.
template <class T>
struct RodRow {
  LaneSym<T> pivot;
  LaneMat<T> near, far;
  LaneVec<T> right;
};
/// Rows of a joint and the link after it.
template <class T>
struct RodScratch {
  RodRow<T> joint, link;
  Wide<T> s;
  LaneVec<T> v, g;
};

namespace rod_detail {

template <class T>
LaneVec<T> load3(const T* p) {
  constexpr int kLanes = Wide<T>::kLanes;
  LaneVec<T> r;
  for (int i = 0; i < kLanes; ++i) r.x.v[i] = p[i], r.y.v[i] = p[kLanes + i], r.z.v[i] = p[2 * kLanes + i];
  return r;
}
template <class T>
Wide<T> load1(const T* p) {
  Wide<T> r;
  for (int i = 0; i < Wide<T>::kLanes; ++i) r.v[i] = p[i];
  return r;
}
template <class T>
void store3(const LaneVec<T>& a, T* p) {
  constexpr int kLanes = Wide<T>::kLanes;
  for (int i = 0; i < kLanes; ++i) p[i] = a.x.v[i], p[kLanes + i] = a.y.v[i], p[2 * kLanes + i] = a.z.v[i];
}

/// conj(a) b with the sign of rod_strain.h: real part and vector part.
template <class T>
void turn_between(const Wide<T> a[4], const Wide<T> b[4], Wide<T>& s, LaneVec<T>& v) {
  s = madd(a[0], b[0], madd(a[1], b[1], madd(a[2], b[2], a[3] * b[3])));
  const LaneVec<T> u{a[1], a[2], a[3]}, w{b[1], b[2], b[3]};
  v = w * a[0] - u * b[0] - cross(u, w);
  const Wide<T> sign = where_positive(-s, Wide<T>(T(-1)), Wide<T>(T(1)));
  s *= sign, v = v * sign;
}

/// A row after the two before it have been eliminated; `row` holds its own couplings.
template <class T>
void eliminate(LaneSym<T> diagonal, const RodRow<T>& last, const RodRow<T>& before_last, RodRow<T>& row) {
  const LaneMat<T> far = row.far * before_last.pivot;
  row.near = row.near - times_transposed(far, last.near);
  const LaneMat<T> near = row.near * last.pivot;
  diagonal.add(T(-1), far, row.far), diagonal.add(T(-1), near, row.near);
  row.right = row.right - far * before_last.right - near * last.right;
  row.pivot = inverse(diagonal);
}

template <class T>
RodRow<T> no_row() {
  return {LaneSym<T>::zero(), LaneMat<T>::zero(), LaneMat<T>::zero(), LaneVec<T>::zero()};
}

}  // namespace rod_detail

/// Current strains of all rods, in the layout of `before`.
template <class T>
void measure_rods(const Rods<T>& c, const T* rows, const T* frames, T* out) {
  using namespace rod_detail;
  using W = Wide<T>;
  constexpr size_t kLanes = W::kLanes;
  W x0[4], x1[4], q0[4], q1[4];
  gather_rows4(rows, c.points, x0), gather_rows4(frames, c.frames, q0);
  for (size_t j = 0; j <= c.links; ++j) {
    gather_rows4(frames, c.frames + (j + 1) * kLanes, q1);
    W s;
    LaneVec<T> v;
    turn_between(q0, q1, s, v);
    store3(v * (W(T(2)) * load1(c.joint_per_length + j * kLanes)) - load3(c.rest + 3 * j * kLanes),
           out + 6 * j * kLanes);
    if (j == c.links) return;
    gather_rows4(rows, c.points + (j + 1) * kLanes, x1);
    const LaneVec<T> d =
        LaneVec<T>{x1[0] - x0[0], x1[1] - x0[1], x1[2] - x0[2]} + load3(c.base + 3 * j * kLanes);
    LaneVec<T> g = transposed_times(lane_rotation(q1), d) * load1(c.per_length + j * kLanes);
    g.z -= W(T(1));
    store3(g, out + (6 * j + 3) * kLanes);
    for (int k = 0; k < 4; ++k) x0[k] = x1[k], q0[k] = q1[k];
  }
}

/// Moves the points of all rows and turns the frames by the correction. `scratch` has links + 1 rows. Returns
/// the largest q of all points.
template <class T>
T solve_rods(const Rods<T>& c, const PerStep<T>& per, T* rows, T* frames, RodScratch<T>* scratch) {
  using namespace rod_detail;
  using W = Wide<T>;
  using V = LaneVec<T>;
  using M = LaneMat<T>;
  constexpr size_t kLanes = W::kLanes;
  const W per_h2(per.h2), one(T(1)), two(T(2)), share(1 / (1 + c.gamma)), soft = per_h2 * share;
  const size_t n = c.links;

  /// -C - alpha~ lambda - gamma (C - C_n), over 1 + gamma; `at` counts joints and links together.
  const auto right_of = [&](const V& strain, const V& compliance, size_t at) {
    V b = V::zero() - strain;
    if (c.lambda) b = b - scaled(compliance, load3(c.lambda + 3 * at * kLanes)) * per_h2;
    if (c.before) b = b - (strain - load3(c.before + 3 * at * kLanes)) * W(c.gamma);
    return b * share;
  };

  W x0[4], x1[4], q0[4], q1[4], i4[4];
  gather_rows4(rows, c.points, x0), gather_rows4(frames, c.frames, q0);
  gather_rows4(c.inverse_inertia, c.frames, i4);
  V w0{i4[0], i4[1], i4[2]};
  M turn0 = lane_rotation(q0), stretch0 = M::zero(), bend0 = M::zero();
  W per_l0 = W::zero(), weight0 = W::zero();
  const RodRow<T> none = no_row<T>();
  const RodRow<T>*joint_before = &none, *link_before = &none;
  for (size_t j = 0; j <= n; ++j) {
    RodScratch<T>& at = scratch[j];
    gather_rows4(frames, c.frames + (j + 1) * kLanes, q1);
    gather_rows4(c.inverse_inertia, c.frames + (j + 1) * kLanes, i4);
    const V w1{i4[0], i4[1], i4[2]};
    turn_between(q0, q1, at.s, at.v);
    const W per_joint = load1(c.joint_per_length + j * kLanes);
    const V compliance = load3(c.bend + 3 * j * kLanes);
    const V strain = at.v * (two * per_joint) - load3(c.rest + 3 * j * kLanes);
    // Derivatives by the frames before and after.
    const M by0 = M::turn(at.s, V::zero() - at.v) * (-per_joint), by1 = M::turn(at.s, at.v) * per_joint;
    const M weighed0 = times_diagonal(by0, w0), weighed1 = times_diagonal(by1, w1);
    LaneSym<T> diagonal = LaneSym<T>::diagonal(compliance * soft);
    diagonal.add(T(1), weighed0, by0), diagonal.add(T(1), weighed1, by1);
    at.joint.near = times_transposed(weighed0, stretch0);
    at.joint.far = times_transposed(weighed0, bend0);
    at.joint.right = right_of(strain, compliance, 2 * j);
    eliminate(diagonal, *link_before, *joint_before, at.joint);
    if (j == n) break;

    gather_rows4(rows, c.points + (j + 1) * kLanes, x1);
    const V d = V{x1[0] - x0[0], x1[1] - x0[1], x1[2] - x0[2]} + load3(c.base + 3 * j * kLanes);
    const W per_l = load1(c.per_length + j * kLanes);
    const M turn1 = lane_rotation(q1);
    at.g = transposed_times(turn1, d) * per_l;
    const V stretch_compliance = load3(c.stretch + 3 * j * kLanes);
    const V g{at.g.x, at.g.y, at.g.z - one};
    const M by_turn = M::turn(W::zero(), at.g), weighed = times_diagonal(by_turn, w1);
    diagonal = LaneSym<T>::diagonal(stretch_compliance * soft);
    const W weight = (x0[3] + x1[3]) * per_l * per_l;
    diagonal.xx += weight, diagonal.yy += weight, diagonal.zz += weight;
    diagonal.add(T(1), weighed, by_turn);
    at.link.near = times_transposed(weighed, by1);
    at.link.far = transposed_times(turn1, turn0) * (-(weight0 * per_l0 * per_l));
    at.link.right = right_of(g, stretch_compliance, 2 * j + 1);
    eliminate(diagonal, at.joint, *link_before, at.link);

    for (int k = 0; k < 4; ++k) x0[k] = x1[k], q0[k] = q1[k];
    w0 = w1, turn0 = turn1, stretch0 = by_turn, bend0 = by1, per_l0 = per_l, weight0 = x1[3];
    joint_before = &at.joint, link_before = &at.link;
  }

  const auto total = [&](const V& l, size_t at) {
    if (!c.lambda) return l;
    T* lambda = c.lambda + 3 * at * kLanes;
    const V sum = l + load3(lambda);
    rod_detail::store3(sum, lambda);
    return sum;
  };
  // Backwards: joint j + 1 and link j are known before joint j.
  W most = W::zero(), pull_after = W::zero();
  V force_after = V::zero(), joint_after, link_after = V::zero();
  {
    RodScratch<T>& at = scratch[n];
    joint_after = at.joint.pivot * at.joint.right;
    total(joint_after, 2 * n);
  }
  for (size_t j = n; j-- > 0;) {
    const RodScratch<T>&at = scratch[j], &next = scratch[j + 1];
    V b = at.link.right - transposed_times(next.joint.near, joint_after);
    if (j + 1 < n) b = b - transposed_times(next.link.far, link_after);
    const V link = at.link.pivot * b;
    b = at.joint.right - transposed_times(at.link.near, link) - transposed_times(next.joint.far, joint_after);
    const V joint = at.joint.pivot * b;
    const V all = total(link, 2 * j + 1);
    total(joint, 2 * j);

    const W per_l = load1(c.per_length + j * kLanes), per_b = load1(c.joint_per_length + j * kLanes),
            per_e = load1(c.joint_per_length + (j + 1) * kLanes);
    gather_rows4(frames, c.frames + (j + 1) * kLanes, q1);
    gather_rows4(c.inverse_inertia, c.frames + (j + 1) * kLanes, i4);
    const V force = lane_rotation(q1) * (link * per_l);
    // J^T of the link, of the joint before it and of the joint after it.
    const V moment = cross(link, at.g) + (joint * at.s - cross(at.v, joint)) * per_b -
                     (joint_after * next.s + cross(next.v, joint_after)) * per_e;
    const W half(T(0.5));
    const W tx = half * moment.x * i4[0], ty = half * moment.y * i4[1], tz = half * moment.z * i4[2];
    W q[4];
    q[0] = q1[0] - madd(q1[1], tx, madd(q1[2], ty, q1[3] * tz));
    q[1] = q1[1] + madd(q1[0], tx, nmadd(q1[3], ty, q1[2] * tz));
    q[2] = q1[2] + madd(q1[0], ty, nmadd(q1[1], tz, q1[3] * tx));
    q[3] = q1[3] + madd(q1[0], tz, nmadd(q1[2], tx, q1[1] * ty));
    const W size = one / sqrt(madd(q[0], q[0], madd(q[1], q[1], madd(q[2], q[2], q[3] * q[3]))));
    for (auto& k : q) k *= size;
    scatter_rows4(frames, c.frames + (j + 1) * kLanes, q);

    const W pull = -(all.z * per_l * per_l);
    gather_rows4(rows, c.points + (j + 1) * kLanes, x1);
    x1[0] = madd(x1[3], force.x - force_after.x, x1[0]), x1[1] = madd(x1[3], force.y - force_after.y, x1[1]),
    x1[2] = madd(x1[3], force.z - force_after.z, x1[2]);
    scatter_rows4(rows, c.points + (j + 1) * kLanes, x1);
    most = max(most, x1[3] * (pull + pull_after));
    pull_after = pull, force_after = force, joint_after = joint, link_after = link;
  }
  gather_rows4(rows, c.points, x0);
  x0[0] = nmadd(x0[3], force_after.x, x0[0]), x0[1] = nmadd(x0[3], force_after.y, x0[1]),
  x0[2] = nmadd(x0[3], force_after.z, x0[2]);
  scatter_rows4(rows, c.points, x0);
  most = max(most, x0[3] * pull_after);
  T q_most = 0;
  for (size_t i = 0; i < kLanes; ++i) q_most = most.v[i] > q_most ? most.v[i] : q_most;
  return q_most;
}

}  // namespace truestep::xpbd
