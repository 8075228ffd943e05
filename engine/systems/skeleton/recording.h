// A recorded motion from any file: the file's joints, and for every frame and joint its rotation and shift
// from rest.
#pragma once
#include "engine/geometry/read/bvh.h"
#include "engine/geometry/read/gltf.h"
#include "engine/kernels/animation/skinning.h"

namespace truestep::skeleton {

struct RecordedJoint {
  std::string name;  ///< unique: the second one of a name ends with _2
  int32_t parent = -1;
  Vec3 offset;              ///< the file's unit, in the parent's frame
  Quat rest;                ///< in the parent's frame
  std::optional<Vec3> end;  ///< end of its bone if no joint follows
  bool moves = false;       ///< whether the file gives its position
};

struct Recording {
  std::vector<RecordedJoint> joints;  ///< parents first
  size_t frames = 0;
  double frame_time = 1.0 / 30;  ///< s
  std::vector<Quat> turns;       ///< frames x joints, from rest
  std::vector<Vec3> shifts;      ///< frames x joints, in the joint's frame at rest, the file's unit
  std::vector<double> values;    ///< frames x joints, for hinges and slides; empty if the file has none
};

Recording recording_of(const BvhMotion& motion);
/// The joints of the file's first skin (without one, all nodes that move or have moved children) and one of
/// its animations, by name or the first, sampled at `rate` (1/s). Throws GltfFault.
Recording recording_of(const GltfModel& model, const std::string& animation, double rate);

/// The mesh attached to the file's first skin, in the file's unit, with the joints at rest.
struct RecordedSkin {
  std::vector<Vec3> vertices;
  std::vector<animation::SkinWeights> weights;  ///< joints as indices into the recording
  std::vector<std::array<uint32_t, 3>> triangles;
};
RecordedSkin skin_of(const GltfModel& model, const std::string& animation);

}  // namespace truestep::skeleton
