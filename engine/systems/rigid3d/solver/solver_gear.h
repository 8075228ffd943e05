// Gears of a step: first coordinate + ratio * second = 0 over the drives of two joints, solved one after the
// other. The impulse acts along directions that do not affect the locked rows of both joints
// (joint_drives3.h).
#pragma once
#include <span>

#include "engine/kernels/rigid/joint_drives3.h"

namespace truestep::rigid3d {

template <class T>
struct GearRow {
  uint32_t joint = 0;
  struct Mesh {
    uint32_t group = 0, drive = 0;  ///< indices in the solver's lists
    int lane = 0;
  } mesh[2];
  T ratio = 1, error = 0;  ///< of coordinates; at the start of the step
  T impulse = 0;
  // Computed anew in every substep.
  struct End {
    uint32_t slot;
    T j[6], p[6];
  } end[4];
  T gap, drift, inverse_k;
};

template <class T>
void prepare_gear(GearRow<T>& gear, std::span<const JointGroup<T>> groups,
                  std::span<const JointDrive<T>> drives, uint32_t end);
/// Adds the gear's impulse, times `times`, to the records.
template <class T>
void apply_gear(const GearRow<T>& gear, Record8<T>* records, uint32_t end, T times);
template <ContactSolve kind, class T>
void solve_gear(GearRow<T>& gear, Record8<T>* v, uint32_t end, const JointPass<T>& pass);

}  // namespace truestep::rigid3d
