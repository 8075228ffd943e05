// Recorded motion on a skeleton: turns of joints between frames by slerp, the root's way linearly, both
// smoothed by a Gaussian where that is asked for. A file's joint gives its turn, less its rest pose, to the
// joint it is mapped to; what that moves is scaled to the size of this skeleton. Foot contacts are frames in
// which a foot is low and slow; a locked foot is brought to the middle of its places in such a stance, and on
// the way there and back over a blend (Kovar, Schreiner, Gleicher 2002, without their change of bone
// lengths).
#pragma once
#include "engine/systems/skeleton/model.h"
#include "engine/systems/skeleton/recording.h"

namespace truestep::skeleton {

/// What a motion's file holds; nothing where it comes from markers. Error "scene_invalid" with the file's
/// line or byte and pointers below `where`.
std::optional<Recording> read_recording(const MotionDef& def, const std::string& where);
/// A scene whose joints, and skin, are those of the motion file where it has none of its own.
SkeletonDef with_file(SkeletonDef def, std::optional<Recording>& file);

class Clip {
 public:
  Clip() = default;
  /// Faults go to the driver.
  Clip(const MotionDef& def, const Recording& file, const Model& model, animation::Driver& driver,
       const std::string& where);

  /// Turns and shifts of the mapped joints at t (s).
  void pose(double t, std::span<animation::JointMotion> motion) const;
  /// Of that, a share from what `motion` is; or as much of its way from its first frame on top of that.
  void blend(double t, double share, LayerDef::Mode mode, std::span<animation::JointMotion> motion) const;
  /// The pose of a frame.
  void frame(size_t f, std::span<animation::JointMotion> motion) const;
  /// Sets what it says something about to 1, per joint.
  void mark(std::span<uint8_t> known) const;
  /// Where locked feet are to be at t: goals for the foot's origin; nothing to do where the weight is 0.
  struct Hold {
    uint32_t foot = 0, base = 0;
    Vec3 move;  ///< m, from where the motion has the foot to where it is held
  };
  size_t feet() const { return feet_.size(); }
  Hold hold(size_t foot, double t) const;
  double slide() const { return slide_; }
  size_t frames() const { return frames_; }

 private:
  struct Track {
    uint32_t joint = 0;
    std::vector<Quat> turns;
    std::vector<Vec3> shifts;    ///< none: stays
    std::vector<double> values;  ///< of a hinge or slide, instead of turns
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
