// Rotation of bodies within a step where joints hold some: rotation vectors that compose as rotations do,
//   p' = w + (p x w) / 2 + p x (p x w) / 12 + ..      (Bortz 1971, w about the body's own axes).
// Between impulses a body rotates freely and keeps its angular momentum: gyroscopic torques from the start of
// the step would do work on spins that joints have turned since.
#include <algorithm>

#include "engine/kernels/rigid/free_rotation.h"
#include "engine/systems/rigid3d/solver/solver.h"

namespace truestep::rigid3d {
template <class T>
void ContactSolver<T>::move_jointed(T h) {
  const size_t n = body_.size();
  const auto end = static_cast<uint32_t>(n);
  team_.for_blocks(n, kBodiesPerBlock, [&](size_t begin, size_t last) {
    // Half of the change by free rotation before the move and half after it: the mean spin of both ends keeps
    // the angular momentum.
    for (size_t i = begin; i < last; ++i) {
      Turning& turning = turning_[i];
      if (!turning.asymmetric) continue;
      T* v = velocity_[i].x + 3;
      const Vec3& r = turning.root;
      turning.half =
          free_rotation::spin_change({v[0] / r.x, v[1] / r.y, v[2] / r.z}, turning.ratios, double(h));
      turning.half = free_rotation::times(turning.half, r) * 0.5;
      v[0] += T(turning.half.x), v[1] += T(turning.half.y), v[2] += T(turning.half.z);
    }
    for (size_t i = begin; i < last; i += W::kLanes) {
      uint32_t at[W::kLanes];
      for (uint32_t k = 0; k < W::kLanes; ++k) at[k] = static_cast<uint32_t>(std::min(i + k, n));
      W v[6], d[6], c[6], once[3], twice[3];
      gather6(velocity_.data(), at, v), gather6(displacement_.data(), at, d), gather6(cross_.data(), at, c);
      for (W& x : v) x *= W(h);
      // In the scaled variables, (a x b)_k is c_k (a_l b_m - a_m b_l).
      const auto cross = [&c](const W a[3], const W b[3], W out[3]) {
        contact_rows::cross(a, b, out);
        for (int e = 0; e < 3; ++e) out[e] *= c[e];
      };
      cross(d + 3, v + 3, once), cross(d + 3, once, twice);
      for (int e = 0; e < 3; ++e) {
        d[e] += v[e], d[3 + e] += madd(W(T(1.0 / 12)), twice[e], madd(W(T(0.5)), once[e], v[3 + e]));
        // In the frame of the body at the start of the step.
        v[3 + e] += madd(W(T(0.5)), twice[e], once[e]);
      }
      scatter6(moved_.data(), at, end, v), scatter6(displacement_.data(), at, end, d);
    }
    for (size_t i = begin; i < last; ++i) {
      if (!turning_[i].asymmetric) continue;
      const double half[3] = {turning_[i].half.x, turning_[i].half.y, turning_[i].half.z};
      // It is not part of the impulses that the next substep starts from.
      for (int e = 0; e < 3; ++e) velocity_[i].x[3 + e] += T(half[e]), start_[i].x[3 + e] += T(2 * half[e]);
    }
  });
}

template void ContactSolver<float>::move_jointed(float);
template void ContactSolver<double>::move_jointed(double);

}  // namespace truestep::rigid3d
