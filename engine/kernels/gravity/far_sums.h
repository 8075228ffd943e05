// What bodies and nodes do to the bodies of a group, eight (floats) or four (doubles) of them side by side. s
// is the vector from a body to a source, R^2 = s^2 + eps^2:
//   body  a = m w(s) s
//   node  a = s (M/R^3 - 3/2 tr S/R^5 + 5/2 3 s.S s/R^7) - 3 S s/R^5
//   phi   = -M/R + 1/2 tr S/R^3 - 3/2 s.S s/R^5
// which is the exact second order of Plummer's softened field; other softenings end before a node's distance.
#pragma once
#include <array>
#include <cstddef>

#include "engine/kernels/gravity/softening.h"

namespace truestep::gravity {

enum class Sums : uint8_t { accelerations, accelerations_and_potentials };

/// A source relative to the group's centre.
template <class T>
struct alignas(4 * sizeof(T)) BodySource {
  T x, y, z, m;
};
struct alignas(16) NodeSource {
  float x, y, z, m;
  std::array<float, 8> s;  ///< BodyTree::Moments
};

/// Places of a group's bodies relative to its centre and what is summed for them: acceleration and sum m p.
/// The rows after the last body are copies of it.
template <class T, size_t kMost>
struct alignas(64) GroupSums {
  static constexpr size_t kLanes = Wide<T>::kLanes;
  using Column = std::array<T, kMost>;
  Column x, y, z, ax, ay, az, p;
  size_t rows = 0;  ///< whole lanes

  void clear(size_t bodies) {
    rows = (bodies + kLanes - 1) / kLanes * kLanes;
    for (Column* c : {&ax, &ay, &az, &p}) c->fill(0);
  }
};

namespace far_detail {

template <class T>
Wide<T> load(const T* p) {
  return {*reinterpret_cast<const typename Wide<T>::Raw*>(p)};
}
template <class T>
void add(T* p, Wide<T> a) {
  *reinterpret_cast<typename Wide<T>::Raw*>(p) += a.v;
}

/// Lanes of bodies that a pass over the sources serves.
template <class T>
struct Targets {
  Wide<T> x, y, z, ax = Wide<T>::zero(), ay = Wide<T>::zero(), az = Wide<T>::zero(), p = Wide<T>::zero();
  template <class G>
  Targets(const G& g, size_t at) : x(load(&g.x[at])), y(load(&g.y[at])), z(load(&g.z[at])) {}
  template <class G>
  void add_to(G& g, size_t at) const {
    add(&g.ax[at], ax), add(&g.ay[at], ay), add(&g.az[at], az), add(&g.p[at], p);
  }
};

template <Sums kSums, class T, class Law>
inline void meet(Targets<T>& t, const BodySource<T>& b, const Law& law) {
  const Wide<T> x = Wide<T>(b.x) - t.x, y = Wide<T>(b.y) - t.y, z = Wide<T>(b.z) - t.z, m(b.m);
  Wide<T> inverse;
  const Wide<T> f = law(madd(x, x, madd(y, y, z * z)), inverse) * m;
  t.ax = madd(f, x, t.ax), t.ay = madd(f, y, t.ay), t.az = madd(f, z, t.az);
  if constexpr (kSums == Sums::accelerations_and_potentials) t.p = madd(inverse, m, t.p);
}

template <Sums kSums, class Law>
inline void meet(Targets<float>& t, const NodeSource& n, const Law& law) {
  using W = Wide<float>;
  const W x = W(n.x) - t.x, y = W(n.y) - t.y, z = W(n.z) - t.z, m(n.m);
  W inverse;
  const W cube = law(madd(x, x, madd(y, y, z * z)), inverse), square = inverse * inverse;
  const W sx = madd(W(n.s[0]), x, madd(W(n.s[1]), y, W(n.s[2]) * z));
  const W sy = madd(W(n.s[1]), x, madd(W(n.s[3]), y, W(n.s[4]) * z));
  const W sz = madd(W(n.s[2]), x, madd(W(n.s[4]), y, W(n.s[5]) * z));
  const W q = square * madd(sx, x, madd(sy, y, sz * z)), trace(n.s[6]);
  const W f = cube * madd(square, madd(W(2.5f), q, -trace), m), g = cube * square;
  t.ax = nmadd(g, sx, madd(f, x, t.ax)), t.ay = nmadd(g, sy, madd(f, y, t.ay));
  t.az = nmadd(g, sz, madd(f, z, t.az));
  if constexpr (kSums == Sums::accelerations_and_potentials) {
    t.p = madd(inverse, madd(square, madd(W(0.5f), q, W(-1.0f / 3) * trace), m), t.p);
  }
}

}  // namespace far_detail

/// Adds what `count` sources do to every body of the group.
template <Sums kSums, class T, size_t kMost, class Source, class Law>
void add_sources(GroupSums<T, kMost>& g, const Source* sources, size_t count, const Law& law) {
  constexpr size_t kLanes = Wide<T>::kLanes;
  size_t at = 0;
  for (; at + 2 * kLanes <= g.rows; at += 2 * kLanes) {
    far_detail::Targets<T> a(g, at), b(g, at + kLanes);
    for (size_t k = 0; k < count; ++k) meet<kSums>(a, sources[k], law), meet<kSums>(b, sources[k], law);
    a.add_to(g, at), b.add_to(g, at + kLanes);
  }
  if (at < g.rows) {
    far_detail::Targets<T> a(g, at);
    for (size_t k = 0; k < count; ++k) meet<kSums>(a, sources[k], law);
    a.add_to(g, at);
  }
}

}  // namespace truestep::gravity
