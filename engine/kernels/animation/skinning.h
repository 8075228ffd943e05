// A skin that follows bones. Each vertex has up to four bones with weights that add to 1; T_b is what takes
// bone b's rest pose to its present one.
//   linear:           x' = (sum w_b T_b) x                 (Magnenat-Thalmann, Laperriere, Thalmann 1988)
//   dual quaternions: x' = (sum w_b q_b) / |sum w_b q_b|, q_b the unit dual quaternions of T_b with the signs
//   of
//                     the first one                                      (Kavan, Collins, Zara, O'Sullivan
//                     2008)
// Between two bones that are twisted by theta the linear mean shrinks by cos(theta/2), to nothing at half a
// turn; dual quaternions keep the distance to the axis.
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

/// present rest^-1: three columns of a rotation matrix and a move, each of four numbers, the last one 0.
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

/// Bone of the rest pose for weights: from a to b.
struct BoneSegment {
  Vec3 a, b;  ///< m
};
/// Weights that fall with the power of the distance from the segments, of the four nearest ones, nearest
/// first.
SkinWeights weights_by_distance(std::span<const BoneSegment> bones, const Vec3& x, double power);

}  // namespace truestep::animation
