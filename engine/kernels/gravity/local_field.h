// The field of far nodes around a place, as a Taylor series in the place u of a body:
//   p(u) = sum m/R = L0 + L1.u + 1/2 L2:uu + 1/6 L3:uuu,    a = grad p = L1 + L2 u + 1/2 L3:uu
//   L0 = M psi + 1/2 S:D2,  L1 = -(M D1 + 1/2 S:D3),  L2 = M D2,  L3 = -M D3,
//   D_n the n-th gradient of psi = 1/R at s,
// all terms of third order in sizes over distances (Dehnen 2002, J. Comput. Phys. 179:27, eq. 3 with p = 3),
// softened as in Plummer's law. Eight nodes are summed at a time, whatever the number of bodies, whereas
// far_sums.h sums over every body in turn.
#pragma once
#include "engine/kernels/gravity/far_sums.h"

namespace truestep::gravity {

/// L0 to L3, a number each: 1, x y z, xx xy xz yy yz zz, xxx xxy xxz xyy xyz xzz yyy yyz yzz zzz.
struct FieldSeries {
  static constexpr size_t kTerms = 20;
  // clang-format off
  enum Term : size_t { l0, x, y, z, xx, xy, xz, yy, yz, zz, xxx, xxy, xxz, xyy, xyz, xzz, yyy, yyz, yzz, zzz };
  // clang-format on
  std::array<float, kTerms> t{};

  FieldSeries& operator+=(const FieldSeries& other) {
    for (size_t k = 0; k < kTerms; ++k) t[k] += other.t[k];
    return *this;
  }
  /// The same field expanded about the position (ux, uy, uz).
  FieldSeries shifted(float ux, float uy, float uz) const;
  /// Adds the field at the positions of a group's bodies to their sums.
  template <size_t kMost>
  void add_to(GroupSums<float, kMost>& g) const;

 private:
  template <class L>
  struct At;
};

/// Sums the series of many nodes about one position.
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

  /// The series of all nodes added so far.
  FieldSeries series(float eps2);

 private:
  using Lanes = Wide<float>;
  using enum FieldSeries::Term;
  static constexpr size_t kNumbers = 11, kTerms = FieldSeries::kTerms;

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

inline FieldSeries LocalField::series(float eps2) {
  if (waiting_ > 0) {  // padded with massless nodes
    for (int k = waiting_; k < Lanes::kLanes; ++k) {
      pending_[0].set(k, 1);
      for (size_t number = 1; number < kNumbers; ++number) pending_[number].set(k, 0);
    }
    take_pending(eps2);
  }
  FieldSeries out;
  for (size_t k = 0; k < kTerms; ++k) {
    const Lanes& v = terms_[k];
    out.t[k] = ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7]));
  }
  return out;
}

/// The value, gradient and higher derivatives of the series at u, for one position or eight.
template <class L>
struct FieldSeries::At {
  L p, gx, gy, gz;                 // value and slope
  L hxx, hxy, hxz, hyy, hyz, hzz;  // 1/2 L3:u

  At(const std::array<L, kTerms>& t, const L& ux, const L& uy, const L& uz, const L& half,
     const L& third_part) {
    const auto third = [&](Term a, Term b, Term c) { return (t[a] * ux + (t[b] * uy + t[c] * uz)) * half; };
    hxx = third(xxx, xxy, xxz), hxy = third(xxy, xyy, xyz), hxz = third(xxz, xyz, xzz);
    hyy = third(xyy, yyy, yyz), hyz = third(xyz, yyz, yzz), hzz = third(xzz, yzz, zzz);
    const auto row = [&](const L& a, const L& b, const L& c) { return a * ux + (b * uy + c * uz); };
    gx = t[x] + row(t[xx] + hxx, t[xy] + hxy, t[xz] + hxz),
    gy = t[y] + row(t[xy] + hxy, t[yy] + hyy, t[yz] + hyz);
    gz = t[z] + row(t[xz] + hxz, t[yz] + hyz, t[zz] + hzz);
    const auto second = [&](const L& a, const L& b) { return a * half + b * third_part; };
    p = t[l0] + (ux * (t[x] + row(second(t[xx], hxx), second(t[xy], hxy), second(t[xz], hxz))) +
                 (uy * (t[y] + row(second(t[xy], hxy), second(t[yy], hyy), second(t[yz], hyz))) +
                  uz * (t[z] + row(second(t[xz], hxz), second(t[yz], hyz), second(t[zz], hzz)))));
  }
};

inline FieldSeries FieldSeries::shifted(float ux, float uy, float uz) const {
  const At<float> at(t, ux, uy, uz, 0.5f, 1.0f / 3);
  FieldSeries out = *this;
  out.t[l0] = at.p, out.t[x] = at.gx, out.t[y] = at.gy, out.t[z] = at.gz;
  out.t[xx] += 2 * at.hxx, out.t[xy] += 2 * at.hxy, out.t[xz] += 2 * at.hxz;
  out.t[yy] += 2 * at.hyy, out.t[yz] += 2 * at.hyz, out.t[zz] += 2 * at.hzz;
  return out;
}

template <size_t kMost>
void FieldSeries::add_to(GroupSums<float, kMost>& g) const {
  using Lanes = Wide<float>;
  std::array<Lanes, kTerms> wide;
  for (size_t k = 0; k < kTerms; ++k) wide[k] = Lanes(t[k]);
  for (size_t at = 0; at < g.rows; at += Lanes::kLanes) {
    const At<Lanes> here(wide, far_detail::load(&g.x[at]), far_detail::load(&g.y[at]),
                         far_detail::load(&g.z[at]), Lanes(0.5f), Lanes(1.0f / 3));
    far_detail::add(&g.ax[at], here.gx), far_detail::add(&g.ay[at], here.gy),
        far_detail::add(&g.az[at], here.gz);
    far_detail::add(&g.p[at], here.p);
  }
}

}  // namespace truestep::gravity
