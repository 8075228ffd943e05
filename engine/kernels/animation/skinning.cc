#include "engine/kernels/animation/skinning.h"

#include <algorithm>
#include <cmath>

#include "engine/math/lanes.h"

namespace truestep::animation {

namespace {

Pose moved_by(const Pose& rest, const Pose& present) {
  const Quat turn = normalized(present.orientation * conjugate(rest.orientation));
  return {present.position - rotate(turn, rest.position), turn};
}

}  // namespace

BoneMatrix bone_matrix(const Pose& rest, const Pose& present) {
  const Pose by = moved_by(rest, present);
  const Rotation r = rotation(by.orientation);
  BoneMatrix out{};
  for (size_t k = 0; k < 3; ++k) {
    out.m[k] = r.row[k].x, out.m[4 + k] = r.row[k].y, out.m[8 + k] = r.row[k].z;
    out.m[12 + k] = (&by.position.x)[k];
  }
  return out;
}

DualQuat dual_quaternion(const Pose& rest, const Pose& present) {
  const Pose by = moved_by(rest, present);
  const Quat &q = by.orientation, d = Quat{0, by.position.x, by.position.y, by.position.z} * q;
  return {{q.w, q.x, q.y, q.z}, {0.5 * d.w, 0.5 * d.x, 0.5 * d.y, 0.5 * d.z}};
}

void skin_linear(std::span<const BoneMatrix> bones, std::span<const SkinWeights> weights, const double* rest,
                 double* out, size_t begin, size_t end) {
  for (size_t i = begin; i < end; ++i) {
    const SkinWeights& s = weights[i];
    Lanes4 m[4] = {Lanes4::zero(), Lanes4::zero(), Lanes4::zero(), Lanes4::zero()};
    for (size_t b = 0; b < kMostBones && s.weight[b] != 0; ++b) {
      const double* bone = bones[s.bone[b]].m;
      for (size_t k = 0; k < 4; ++k) m[k] = m[k].plus(Lanes4::load(bone + 4 * k), s.weight[b]);
    }
    const double* x = rest + 3 * i;
    const Lanes4 moved = m[3].plus(m[0], x[0]).plus(m[1], x[1]).plus(m[2], x[2]);
    if (i + 1 < end) {
      moved.store(out + 3 * i);  // the fourth number belongs to the next vertex, written next
    } else {
      double last[4];
      moved.store(last);
      std::copy_n(last, 3, out + 3 * i);
    }
  }
}

void skin_dual_quaternion(std::span<const DualQuat> bones, std::span<const SkinWeights> weights,
                          const double* rest, double* out, size_t begin, size_t end) {
  for (size_t i = begin; i < end; ++i) {
    const SkinWeights& s = weights[i];
    const double* first = bones[s.bone[0]].real;
    Lanes4 sum[2] = {Lanes4::zero(), Lanes4::zero()};
    for (size_t b = 0; b < kMostBones && s.weight[b] != 0; ++b) {
      const DualQuat& bone = bones[s.bone[b]];
      const double same = (first[0] * bone.real[0] + first[1] * bone.real[1]) +
                          (first[2] * bone.real[2] + first[3] * bone.real[3]);
      const double w = same < 0 ? -s.weight[b] : s.weight[b];
      sum[0] = sum[0].plus(Lanes4::load(bone.real), w), sum[1] = sum[1].plus(Lanes4::load(bone.dual), w);
    }
    double q[4], d[4];
    sum[0].store(q), sum[1].store(d);
    // With v the vector part: x' = x + 2 (v x (v x x + w x) + w d_v - d_w v + v x d_v) / |q|^2.
    const double n2 = (q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]);
    const Vec3 x = load3(rest, i), v{q[1], q[2], q[3]}, dv{d[1], d[2], d[3]};
    const Vec3 move = cross(v, cross(v, x) + x * q[0]) + dv * q[0] - v * d[0] + cross(v, dv);
    store3(out, i, n2 > 0 ? x + move * (2 / n2) : x);
  }
}

SkinWeights weights_by_distance(std::span<const BoneSegment> bones, const Vec3& x, double power) {
  SkinWeights out;
  std::array<double, kMostBones> nearest;
  nearest.fill(HUGE_VAL);
  for (uint32_t b = 0; b < bones.size(); ++b) {
    const Vec3 along = bones[b].b - bones[b].a;
    const double l2 = norm2(along);
    const double s = l2 > 0 ? std::clamp(dot(x - bones[b].a, along) / l2, 0.0, 1.0) : 0;
    double d = norm(x - bones[b].a - along * s);
    uint32_t who = b;
    for (size_t k = 0; k < kMostBones; ++k) {
      if (d < nearest[k]) std::swap(d, nearest[k]), std::swap(who, out.bone[k]);
    }
  }
  // On a bone itself, that bone alone counts.
  constexpr double kOn = 1e-9;  // m
  double sum = 0;
  for (size_t k = 0; k < kMostBones; ++k) {
    const double share = nearest[k] < HUGE_VAL ? (nearest[0] + kOn) / (nearest[k] + kOn) : 0;
    out.weight[k] = share > 0 ? trig::pow(share, power) : 0;
    sum += out.weight[k];
  }
  for (double& w : out.weight) w = w / sum;
  return out;
}

}  // namespace truestep::animation
