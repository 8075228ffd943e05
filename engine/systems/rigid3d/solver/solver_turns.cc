// Rotation of bodies within a step where joints hold some: rotation vectors that compose as rotations do,
//   p' = w + (p x w) / 2 + p x (p x w) / 12 + ..      (Bortz 1971, w about the body's own axes).
// Between impulses a body rotates freely and keeps its angular momentum: gyroscopic torques from the start of
// the step would do work on spins that joints have turned since. In a substep the series are off by
// |p x w| |w| / 12 and |p x w| p^2 / 6, a rotation by the mean spin by h^2 |w x dw| / 12. Where that matters,
// with fast spins whose axis changes, the rotation is that of free_rotation.h, composed by quaternions:
// off-centre springs feed bodies that are not where their angular momentum turns them.
#include <algorithm>
#include <cmath>

#include "engine/kernels/rigid/free_rotation.h"
#include "engine/systems/rigid3d/solver/solver.h"

namespace truestep::rigid3d {

namespace {
/// rad, largest error of the rotations of a substep by series.
constexpr double kSeriesError = 1e-6;

/// Rotation vector (rad) of a rotation by p followed by one by w about the body's own axes: of those of the
/// same orientation, which differ by whole turns, the one nearest to `about`.
Vec3 composed(const Vec3& p, const Vec3& w, const Vec3& about) {
  constexpr double kWhole = 6.283185307179586476925;
  const Vec3 r = free_rotation::rotation_vector(free_rotation::turn(p) * free_rotation::turn(w));
  const double angle = norm(r);
  // Without an angle there is no axis but that of whole turns.
  const Vec3 axis = normalized(angle > 1e-9 ? r : about);
  return r + axis * (kWhole * std::round((dot(about, axis) - angle) / kWhole));
}

/// Square of the error (rad) of rotations by series, from the scaled p, w and p x w.
template <class W>
W series_error2(const W c[3], const W p[3], const W w[3], const W crossed[3]) {
  const auto square = [c](const W a[3]) {
    return madd(a[0] * a[0], c[1] * c[2], madd(a[1] * a[1], c[2] * c[0], a[2] * a[2] * (c[0] * c[1])));
  };
  const W p2 = square(p);
  return square(crossed) * madd(square(w), W(1.0 / 144), p2 * p2 * W(1.0 / 36));
}
}  // namespace

template <class T>
void ContactSolver<T>::turn_exactly(size_t i, const Vec3& before, T h) {
  Turning& turning = turning_[i];
  const Vec3& r = turning.root;
  T* v = velocity_[i].x + 3;
  const auto store = [&r](const Vec3& a, T* scaled) {
    scaled[0] = T(a.x * r.x), scaled[1] = T(a.y * r.y), scaled[2] = T(a.z * r.z);
  };
  const Vec3 half = turning.asymmetric ? free_rotation::divide(turning.half, r) : Vec3{};
  const Vec3 spin = free_rotation::divide({double(v[0]), double(v[1]), double(v[2])}, r) - half;
  const auto end = free_rotation::advance({{}, spin}, moments_[i], double(h));
  const Vec3 p = free_rotation::divide(before, r), w = free_rotation::rotation_vector(end.orientation);
  store(composed(p, w, p + (spin + half) * double(h)), displacement_[i].x + 3);
  store(rotation(free_rotation::turn(p)).apply(w), moved_[i].x + 3);
  if (!turning.asymmetric) return;
  const Vec3 change = rotation(end.orientation).apply_inverse(end.angular_velocity) - spin;
  store(spin + 0.5 * change, v);
  turning.half = 0.5 * free_rotation::times(change, r);
}

template <class T>
void ContactSolver<T>::move_jointed(T h) {
  const size_t n = body_.size();
  const auto end = static_cast<uint32_t>(n);
  team_.for_blocks(n, kBodiesPerBlock, [&](size_t begin, size_t last) {
    // Half of the change by free rotation before the move and half after it: the mean spin of both ends keeps
    // the angular momentum.
    bool any = false;
    for (size_t i = begin; i < last; ++i) {
      Turning& turning = turning_[i];
      if (!turning.asymmetric) continue;
      T* v = velocity_[i].x + 3;
      const Vec3& r = turning.root;
      const Vec3 spin{v[0] / r.x, v[1] / r.y, v[2] / r.z};
      const Vec3 change = free_rotation::spin_change(spin, turning.ratios, double(h));
      turning.half = free_rotation::times(change, r) * 0.5;
      const double bend = double(h) * double(h) / 12;
      turning.bends = norm2(cross(change, spin)) * (bend * bend) > kSeriesError * kSeriesError;
      any |= turning.bends;
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
      const W rest = series_error2(c, d + 3, v + 3, once);
      const W before[3] = {d[3], d[4], d[5]};
      for (int e = 0; e < 3; ++e) {
        d[e] += v[e], d[3 + e] += madd(W(T(1.0 / 12)), twice[e], madd(W(T(0.5)), once[e], v[3 + e]));
        // In the frame of the body at the start of the step.
        v[3 + e] += madd(W(T(0.5)), twice[e], once[e]);
      }
      scatter6(moved_.data(), at, end, v), scatter6(displacement_.data(), at, end, d);
      constexpr T most = T(kSeriesError * kSeriesError);
      if (!any && !any_below(W(most), rest)) continue;
      for (int k = 0; k < W::kLanes; ++k) {
        const size_t body = i + static_cast<size_t>(k);
        if (body >= last || !(turning_[body].bends || rest[k] > most)) continue;
        turn_exactly(body, {double(before[0][k]), double(before[1][k]), double(before[2][k])}, h);
      }
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
