// Skinning: a surface that follows bones. Each vertex has up to four bones with weights that add up to 1; T_b
// takes bone b's rest pose to its present one.
//   linear:           x' = (sum w_b T_b) x                 (Magnenat-Thalmann, Laperriere, Thalmann 1988)
//   dual quaternions: x' = (sum w_b q_b) / |sum w_b q_b|, q_b the unit dual quaternions of T_b with signs
//                     chosen to match the first one        (Kavan, Collins, Zara, O'Sullivan 2008)
// Between two bones twisted by theta relative to each other the linear blend shrinks by cos(theta/2), to
// nothing at half a turn; dual quaternions preserve the distance to the axis.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/kernels/animation/joint_tree.h"

namespace truestep::animation {

inline constexpr size_t kMostBones = 4;

struct SkinWeights {
  std::array<uint32_t, kMostBones> bone{};
  std::array<double, kMostBones> weight{};  ///< of no bone: 0
};

/// present rest^-1: three columns of a rotation matrix and a translation, four numbers each, the last one 0.
struct BoneMatrix {
  double m[16];
};
BoneMatrix bone_matrix(const Pose& rest, const Pose& present);

struct DualQuat {
  double real[4], dual[4];  ///< w x y z
};
DualQuat dual_quaternion(const Pose& rest, const Pose& present);

/// Vertices [begin, end): `rest` and `out` n x 3 (m).
void skin_linear(std::span<const BoneMatrix> bones, std::span<const SkinWeights> weights, const double* rest,
                 double* out, size_t begin, size_t end);
void skin_dual_quaternion(std::span<const DualQuat> bones, std::span<const SkinWeights> weights,
                          const double* rest, double* out, size_t begin, size_t end);

/// Segment of a bone in the rest pose, from a to b, for weights.
struct BoneSegment {
  Vec3 a, b;  ///< m
};
/// Weights of the four nearest segments, nearest first, that fall with the given power of the distance.
SkinWeights weights_by_distance(std::span<const BoneSegment> bones, const Vec3& x, double power);

}  // namespace truestep::animation
