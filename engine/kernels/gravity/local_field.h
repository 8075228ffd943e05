// The field of far nodes around the middle of a group, as a Taylor series in the place u of a body:
//   p(u) = sum m/R = L0 + L1.u + 1/2 L2:uu + 1/6 L3:uuu,    a = grad p = L1 + L2 u + 1/2 L3:uu
//   L0 = M psi + 1/2 S:D2,  L1 = -(M D1 + 1/2 S:D3),  L2 = M D2,  L3 = -M D3,   D_n the n-th gradient of psi
//   = 1/R at s,
// all terms of third order in sizes over distances (Dehnen 2002, J. Comput. Phys. 179:27, eq. 3 with p = 3),
// softened as Plummer does. Eight nodes at a time, whatever the number of bodies, where far_sums.h takes
// every body in turn.
#pragma once
#include "engine/kernels/gravity/far_sums.h"

namespace truestep::gravity {

class LocalField {
 public:
  void clear() {
    waiting_ = 0;
    for (Lanes& t : terms_) t = Lanes::zero();
  }

  /// eps2: the softening's square.
  void add(const NodeSource& n, float eps2) {
    const float numbers[kNumbers] = {n.x,    n.y,    n.z,    n.m,    n.s[0], n.s[1],
                                     n.s[2], n.s[3], n.s[4], n.s[5], n.s[6]};
    for (size_t k = 0; k < kNumbers; ++k) pending_[k].set(waiting_, numbers[k]);
    if (++waiting_ == Lanes::kLanes) take_pending(eps2);
  }

  /// The series at the places of a group's bodies, when all nodes have been added.
  template <size_t kMost>
  void add_to(GroupSums<float, kMost>& g, float eps2);

 private:
  using Lanes = Wide<float>;
  static constexpr size_t kNumbers = 11, kTerms = 20;
  enum Term : size_t {
    l0,
    x,
    y,
    z,
    xx,
    xy,
    xz,
    yy,
    yz,
    zz,
    xxx,
    xxy,
    xxz,
    xyy,
    xyz,
    xzz,
    yyy,
    yyz,
    yzz,
    zzz
  };

  void take_pending(float eps2);

  std::array<Lanes, kNumbers> pending_;
  int waiting_ = 0;
  std::array<Lanes, kTerms> terms_;
};

inline void LocalField::take_pending(float eps2) {
  const auto c = [](float a) { return Lanes(a); };
  const auto& [sx, sy, sz, m, qxx, qxy, qxz, qyy, qyz, qzz, trace] = pending_;  // q = 3 S, trace = 3/2 tr S
  const Lanes r2 = madd(sx, sx, madd(sy, sy, sz * sz)) + c(eps2), inverse = c(1) / sqrt(r2),
              w2 = inverse * inverse, w3 = w2 * inverse, w5 = w3 * w2, w7 = w5 * w2;
  const Lanes qx = madd(qxx, sx, madd(qxy, sy, qxz * sz)), qy = madd(qxy, sx, madd(qyy, sy, qyz * sz)),
              qz = madd(qxz, sx, madd(qyz, sy, qzz * sz)), q = madd(qx, sx, madd(qy, sy, qz * sz));
  auto& t = terms_;
  t[l0] += madd(m, inverse, nmadd(w3, trace * c(1.0f / 3), c(0.5f) * q * w5));
  // a of the node at the middle: far_sums.h.
  const Lanes f = madd(m, w3, nmadd(w5, trace, c(2.5f) * q * w7));
  t[x] += nmadd(w5, qx, f * sx), t[y] += nmadd(w5, qy, f * sy), t[z] += nmadd(w5, qz, f * sz);
  const Lanes m3 = m * w3, m5 = c(3) * m * w5, m7 = c(15) * m * w7;
  const Lanes x2 = sx * sx, y2 = sy * sy, z2 = sz * sz, m5x = m5 * sx, m5y = m5 * sy, m5z = m5 * sz;
  t[xx] += nmadd(c(1), m3, m5x * sx), t[yy] += nmadd(c(1), m3, m5y * sy), t[zz] += nmadd(c(1), m3, m5z * sz);
  t[xy] += m5x * sy, t[xz] += m5x * sz, t[yz] += m5y * sz;
  const Lanes m7x = m7 * sx, m7y = m7 * sy, m7z = m7 * sz;
  t[xxx] += nmadd(c(3), m5x, m7x * x2), t[yyy] += nmadd(c(3), m5y, m7y * y2),
      t[zzz] += nmadd(c(3), m5z, m7z * z2);
  t[xxy] += m7y * x2 - m5y, t[xxz] += m7z * x2 - m5z, t[xyy] += m7x * y2 - m5x;
  t[yyz] += m7z * y2 - m5z, t[xzz] += m7x * z2 - m5x, t[yzz] += m7y * z2 - m5y;
  t[xyz] += m7x * sy * sz;
  waiting_ = 0;
}

template <size_t kMost>
void LocalField::add_to(GroupSums<float, kMost>& g, float eps2) {
  if (waiting_ > 0) {  // filled up with nodes without mass
    for (int k = waiting_; k < Lanes::kLanes; ++k) {
      pending_[0].set(k, 1);
      for (size_t number = 1; number < kNumbers; ++number) pending_[number].set(k, 0);
    }
    take_pending(eps2);
  }
  std::array<Lanes, kTerms> t;
  for (size_t k = 0; k < kTerms; ++k) {
    const Lanes& v = terms_[k];
    t[k] = Lanes(((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7])));
  }
  const Lanes half(0.5f);
  for (size_t at = 0; at < g.rows; at += Lanes::kLanes) {
    const Lanes ux = far_detail::load(&g.x[at]), uy = far_detail::load(&g.y[at]),
                uz = far_detail::load(&g.z[at]);
    // 1/2 L3:u, a symmetric matrix, then L2 + it, times u.
    const auto third = [&](Term a, Term b, Term c) {
      return madd(t[a], ux, madd(t[b], uy, t[c] * uz)) * half;
    };
    const Lanes hxx = third(xxx, xxy, xxz), hxy = third(xxy, xyy, xyz), hxz = third(xxz, xyz, xzz);
    const Lanes hyy = third(xyy, yyy, yyz), hyz = third(xyz, yyz, yzz), hzz = third(xzz, yzz, zzz);
    const auto row = [&](const Lanes& a, const Lanes& b, const Lanes& c) {
      return madd(a, ux, madd(b, uy, c * uz));
    };
    far_detail::add(&g.ax[at], t[x] + row(t[xx] + hxx, t[xy] + hxy, t[xz] + hxz));
    far_detail::add(&g.ay[at], t[y] + row(t[xy] + hxy, t[yy] + hyy, t[yz] + hyz));
    far_detail::add(&g.az[at], t[z] + row(t[xz] + hxz, t[yz] + hyz, t[zz] + hzz));
    const auto second = [&](const Lanes& a, const Lanes& b) { return madd(a, half, b * Lanes(1.0f / 3)); };
    const Lanes gx = row(second(t[xx], hxx), second(t[xy], hxy), second(t[xz], hxz)),
                gy = row(second(t[xy], hxy), second(t[yy], hyy), second(t[yz], hyz)),
                gz = row(second(t[xz], hxz), second(t[yz], hyz), second(t[zz], hzz));
    far_detail::add(&g.p[at], t[l0] + madd(ux, t[x] + gx, madd(uy, t[y] + gy, uz * (t[z] + gz))));
  }
}

}  // namespace truestep::gravity
