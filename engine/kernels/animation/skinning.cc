#include "engine/kernels/animation/skinning.h"

#include <algorithm>
#include <cmath>

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
  BoneMatrix out;
  for (size_t k = 0; k < 3; ++k) {
    out.m[4 * k] = r.row[k].x, out.m[4 * k + 1] = r.row[k].y, out.m[4 * k + 2] = r.row[k].z;
    out.m[4 * k + 3] = (&by.position.x)[k];
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
    double m[12];
    const double* first = bones[s.bone[0]].m;
    for (size_t k = 0; k < 12; ++k) m[k] = s.weight[0] * first[k];
    for (size_t b = 1; b < kMostBones; ++b) {
      if (s.weight[b] == 0) break;
      const double* next = bones[s.bone[b]].m;
      for (size_t k = 0; k < 12; ++k) m[k] += s.weight[b] * next[k];
    }
    const double x = rest[3 * i], y = rest[3 * i + 1], z = rest[3 * i + 2];
    out[3 * i] = m[0] * x + m[1] * y + m[2] * z + m[3];
    out[3 * i + 1] = m[4] * x + m[5] * y + m[6] * z + m[7];
    out[3 * i + 2] = m[8] * x + m[9] * y + m[10] * z + m[11];
  }
}

void skin_dual_quaternion(std::span<const DualQuat> bones, std::span<const SkinWeights> weights,
                          const double* rest, double* out, size_t begin, size_t end) {
  for (size_t i = begin; i < end; ++i) {
    const SkinWeights& s = weights[i];
    const DualQuat& first = bones[s.bone[0]];
    double q[8] = {};
    for (size_t b = 0; b < kMostBones; ++b) {
      if (s.weight[b] == 0) break;
      const DualQuat& next = bones[s.bone[b]];
      double same = 0;
      for (size_t k = 0; k < 4; ++k) same += first.real[k] * next.real[k];
      const double w = same < 0 ? -s.weight[b] : s.weight[b];
      for (size_t k = 0; k < 4; ++k) q[k] += w * next.real[k], q[4 + k] += w * next.dual[k];
    }
    const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double scale = n > 0 ? 1 / n : 0;
    const Quat real = n > 0 ? Quat{q[0] * scale, q[1] * scale, q[2] * scale, q[3] * scale} : Quat{};
    const Quat dual{q[4] * scale, q[5] * scale, q[6] * scale, q[7] * scale};
    const Quat move = dual * conjugate(real);
    store3(out, i, rotate(real, load3(rest, i)) + Vec3{move.x, move.y, move.z} * 2.0);
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
  // On a bone itself that bone alone counts.
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
