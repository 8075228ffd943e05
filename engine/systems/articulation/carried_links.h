// Links that something else moves: the joints take the coordinates in which every link, from the ground on,
// lies nearest to where it is wanted, and of all velocities that the joints allow those that differ least
// from the wanted ones in kinetic energy,
//   q' = M(q)^-1 sum_i J_i^T I_i u_i          u_i: wanted twist of link i, I_i its inertia
// (as if every link's wanted momentum hit the tree at rest), one articulated body solve. What the joints can
// do they do exactly; a tree whose root is free has the wanted momentum and angular momentum in any case.
#pragma once
#include "engine/core/body_access.h"
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
/// and are wanted at rest in their joint.
void carry_links(const Model& model, std::span<const BodyMotion> to, std::span<const uint8_t> given,
                 std::span<double> q, std::span<double> v, CarryWork& work);

}  // namespace truestep::articulation
