// A group of a tree's bodies and the sums for them (lanes/pair_loops.h). s is the vector from a body to a
// source, R^2 = s^2 + eps^2:
//   body  a = m w(s) s
//   node  a = s (M/R^3 - 3/2 tr S/R^5 + 5/2 3 s.S s/R^7) - 3 S s/R^5
//   phi   = -M/R + 1/2 tr S/R^3 - 3/2 s.S s/R^5
// which is the exact second order of Plummer's softened field; other softenings end before a node's distance.
#pragma once
#include <array>

#include "engine/kernels/gravity/softening.h"
#include "engine/math/wide.h"

namespace truestep::gravity {

/// Positions relative to the group's centre, accelerations and sum m p. The rows after the last body are
/// copies of it.
template <class T, size_t kMost>
struct alignas(64) GroupSums {
  static constexpr size_t kUnit = 64 / sizeof(T);
  using Column = std::array<T, (kMost + kUnit - 1) / kUnit * kUnit>;
  Column x, y, z, ax, ay, az, p;
  size_t rows = 0;  ///< whole units

  void clear(size_t bodies) {
    rows = (bodies + kUnit - 1) / kUnit * kUnit;
    for (Column* c : {&ax, &ay, &az, &p}) c->fill(0);
  }
  GroupColumns<T> columns() {
    return {x.data(), y.data(), z.data(), ax.data(), ay.data(), az.data(), p.data(), rows};
  }
};

namespace far_detail {

inline Wide<float> load(const float* p) {
  return {*reinterpret_cast<const Wide<float>::Raw*>(p)};
}
inline void add(float* p, Wide<float> a) {
  *reinterpret_cast<Wide<float>::Raw*>(p) += a.v;
}

}  // namespace far_detail

}  // namespace truestep::gravity
