// Links moved from outside: the joints take the coordinates that put every link, from the ground outwards, as
// close as possible to its target, and the velocities closest to the targets in kinetic energy among those
// the joints allow,
//   q' = M(q)^-1 sum_i J_i^T I_i u_i          u_i: target twist of link i, I_i its inertia
// (as if every link's target momentum were applied as an impulse at rest), one articulated body solve.
// Motions that the joints allow are followed exactly; a tree with a free root has the target momentum and
// angular momentum in any case.
#pragma once
#include "engine/core/ports/body_access.h"
#include "engine/geometry/shape.h"
#include "engine/systems/articulation/model.h"

namespace truestep::articulation {

/// Scratch; grows once.
struct CarryWork {
  std::vector<Pose> poses;        ///< of the links
  std::vector<BodyTwist> twists;  ///< of their centres
  std::vector<Push> pushes;
  std::vector<double> none;
  Work work;
  ClosureWork closures;
};

/// `to`: one per link, of its centre of mass in the world; links whose `given` is 0 keep their coordinates
/// and have zero target velocity in their joint.
void carry_links(const Model& model, std::span<const BodyMotion> to, std::span<const uint8_t> given,
                 std::span<double> q, std::span<double> v, CarryWork& work);

}  // namespace truestep::articulation
