// Data passed between the stages of a skeleton's step, and conversion of coordinates and poses to columns.
#pragma once
#include <algorithm>
#include <utility>

#include "engine/systems/skeleton/skeleton.h"

namespace truestep::skeleton {

struct Skeleton::Scratch {
  animation::Driver::Scratch driver;
  std::vector<animation::JointMotion> motion;
  Pose root;
  std::vector<animation::IkGoal> goals;
  animation::IkWork ik;
  animation::PosePrior::Work prior;
  std::vector<animation::BoneMatrix> matrices;
  std::vector<animation::DualQuat> duals;
  std::vector<double> skin;
  const ThreadArena* arena = nullptr;
};

inline animation::JointMotion read_motion(const double* c) {
  return {c[0], {c[1], c[2], c[3], c[4]}, {c[5], c[6], c[7]}};
}
inline void write_motion(const animation::JointMotion& m, double* c) {
  const double all[] = {m.value, m.turn.w, m.turn.x, m.turn.y, m.turn.z, m.shift.x, m.shift.y, m.shift.z};
  std::ranges::copy(all, c);
}
inline Pose read_pose(const double* c) {
  return {{c[0], c[1], c[2]}, {c[3], c[4], c[5], c[6]}};
}
inline void write_pose(const Pose& p, double* c) {
  const double all[] = {p.position.x,    p.position.y,    p.position.z,   p.orientation.w,
                        p.orientation.x, p.orientation.y, p.orientation.z};
  std::ranges::copy(all, c);
}

/// Extra rows of the coordinates for a skeleton that bodies lead, after those of the n joints: n rows with
/// the coordinates in which bodies left it, then these, as offsets from the first of them.
struct LeadRows {
  static constexpr size_t rows = 4;
  static constexpr size_t by = 0, shift = 1, start = 2,
                          blend = 3;      ///< who leads; s, shift of its own time; s; s
  static constexpr size_t placement = 8;  ///< transform of its own motion
  static constexpr size_t root = 16;      ///< in the last step
  static constexpr size_t left_root = 24;
};
/// Null if nothing leads it.
inline const double* lead_rows(const State& s) {
  const size_t n = s.rows(SkeletonColumns::kJointPosition);
  const auto all = s.f64(SkeletonColumns::kCoordinates);
  return all.size() > 8 * n ? all.data() + 16 * n : nullptr;
}
inline double* lead_rows(State& s) {
  return const_cast<double*>(lead_rows(std::as_const(s)));
}

}  // namespace truestep::skeleton
