// RigPort: how couplings and file writers access a skeleton without knowing its system: its tree of joints,
// the columns with their poses, its bones as bodies, its skin; and how it is led when something else (a
// ragdoll) determines the poses of its bones. Few systems have one, so it is made by rig_of when it is asked
// for (Ports::rig).
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "engine/core/ports/body_port.h"
#include "engine/core/system.h"
#include "engine/kernels/animation/skinning.h"

namespace truestep {

/// How a skeleton returns to its own motion.
struct PoseMatch {
  double blend = 0;  ///< s, duration of the blend from the pose to which it was led
  /// s, interval of its own motion that is searched for the most similar pose; if both are equal, its motion
  /// continues as if it had never been led.
  double from = 0, to = 0;
};

/// A skeleton that can be led by something else.
class FollowsBones {
 public:
  virtual ~FollowsBones() = default;
  /// Adds to the state what is needed for being led. Call once, before the others.
  virtual void prepare(State& state) const = 0;
  /// Sets the bones to `poses` (world, one per bone) where `given` is 1; other joints keep their coordinates.
  /// Velocities are those of the motion from the previous poses in h (s), and unchanged when h is 0. From now
  /// on the skeleton does not move by itself.
  virtual void follow(State& state, std::span<const Pose> poses, std::span<const uint8_t> given, double h,
                      Workspace& workspace) const = 0;
  /// From t (s) on the skeleton moves by itself again. Its motion continues from its present place, rotated
  /// about y and shifted accordingly.
  virtual void resume(State& state, double t, const PoseMatch& match, Workspace& workspace) const = 0;
};

struct RigPort {
  std::span<const std::string> names;  ///< of joints
  std::span<const animation::Joint> joints;
  State::Column position = 0, orientation = 0;  ///< of joints, in the world
  BodyPort bones;
  std::span<const uint32_t> joint_of_bone;
  std::span<const Pose> bone_in_joint;
  std::span<const Vec3> skin;  ///< m, at rest
  std::span<const animation::SkinWeights> weights;
  std::span<const std::array<uint32_t, 3>> triangles;
  std::span<const Pose> rest;  ///< of the joints, to which the skin belongs
  const FollowsBones* follower = nullptr;
};

/// A system with a skeleton. Valid while the system lives.
class Rigged {
 public:
  virtual ~Rigged() = default;
  virtual RigPort rig() const = 0;
};
inline std::optional<RigPort> rig_of(const System& system) {
  const Rigged* rigged = system.ports().rig;
  return rigged ? std::optional(rigged->rig()) : std::nullopt;
}

}  // namespace truestep
