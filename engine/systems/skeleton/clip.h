// Recorded motion on a skeleton: joint rotations are interpolated between frames by slerp, the root's path
// linearly, both smoothed by a Gaussian on request. A joint of the file gives its rotation relative to its
// rest pose to the joint it is mapped to; displacements are scaled to the size of this skeleton. Foot
// contacts are frames in which a foot is low and slow; a locked foot is held at its mean position over such a
// stance and blended in and out (Kovar, Schreiner, Gleicher 2002, without their change of bone lengths).
#pragma once
#include "engine/systems/skeleton/model.h"
#include "engine/systems/skeleton/recording.h"

namespace truestep::skeleton {

/// Reads a motion file; nothing if the motion comes from markers. Error "scene_invalid" with the file's line
/// or byte and pointers below `where`.
std::optional<Recording> read_recording(const MotionDef& def, const std::string& where);
/// The scene with joints, and skin, of the motion file if it has none of its own.
SkeletonDef with_file(SkeletonDef def, std::optional<Recording>& file);

class Clip {
 public:
  Clip() = default;
  /// Faults are reported to the driver.
  Clip(const MotionDef& def, const Recording& file, const Model& model, animation::Driver& driver,
       const std::string& where);

  /// Rotations and shifts of the mapped joints at t (s).
  void pose(double t, std::span<animation::JointMotion> motion) const;
  /// Blends `motion` with this clip's pose by `share`; or adds that share of the clip's change since its
  /// first frame.
  void blend(double t, double share, LayerDef::Mode mode, std::span<animation::JointMotion> motion) const;
  /// The pose of a frame.
  void frame(size_t f, std::span<animation::JointMotion> motion) const;
  /// Sets the entries of joints that the clip moves to 1.
  void mark(std::span<uint8_t> known) const;
  /// Where locked feet should be at t: goals for the foot's origin; inactive if the weight is 0.
  struct Hold {
    uint32_t foot = 0, base = 0;
    Vec3 move;  ///< m, from the foot's position in the motion to where it is held
  };
  size_t feet() const { return feet_.size(); }
  Hold hold(size_t foot, double t) const;
  double slide() const { return slide_; }
  size_t frames() const { return frames_; }

 private:
  struct Track {
    uint32_t joint = 0;
    std::vector<Quat> turns;
    std::vector<Vec3> shifts;    ///< empty: no shifts
    std::vector<double> values;  ///< for a hinge or slide, instead of turns
  };
  struct Foot {
    uint32_t joint = 0, base = 0;
    std::vector<Vec3> moves;  ///< per frame
  };
  struct Between {
    size_t frame = 0;
    double share = 0;
  };
  Between between(double t) const;
  void pose_of(const Track& track, double t, animation::JointMotion& motion) const;
  void smooth(double width);
  void find_contacts(const FootLockDef& def, const Model& model, const std::vector<uint32_t>& feet);

  size_t frames_ = 0;
  double frame_time_ = 1;
  animation::Extend extend_ = animation::Extend::clamp;
  std::vector<Track> tracks_;
  std::vector<Foot> feet_;
  double slide_ = 0;
};

}  // namespace truestep::skeleton
