// Joints of a step that hold a moving body: in SIMD lanes by colour, warm started, and solved before the
// contacts in every pass; gears after them. The state keeps their impulses from step to step.
#pragma once
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/kernels/rigid/joint_drives3.h"
#include "engine/kernels/rigid/soft_constraint.h"
#include "engine/rigid/lanes.h"
#include "engine/systems/rigid3d/contacts.h"
#include "engine/systems/rigid3d/solver/solver_gear.h"

namespace truestep::rigid3d {

/// Impulse of a motor without a bound, N s.
inline constexpr double kAnyImpulse = 1e20;

template <class T>
class JointSolver {
 public:
  using W = Wide<T>;
  /// Bodies of the step: slot[i] is the index of body i in `scaled`, or kNoBody.
  struct Bodies {
    std::span<const BodyNow> now;
    std::span<const uint32_t> slot;
    std::span<const ScaledBody> scaled;
    size_t moving = 0;
  };
  /// Lists the joints of this step and marks the bodies that they move (slot 0).
  void choose(const State& s, std::span<const BodyNow> now, std::span<uint32_t> slot);
  /// The joints of this step, before `fill`.
  std::vector<uint32_t>& listed() { return listed_; }
  /// h: a substep.
  void fill(const State& s, const JointList& joints, const Bodies& bodies, double h, const ThreadTeam& team);
  /// Before the first substep of h: adds the last impulses of the joints to `warm`.
  void start(const JointList& joints, const Record8<T>* moved, Record8<T>* warm, double h,
             const ThreadTeam& team);
  /// True if this step has joints with only springs, before `fill`.
  bool has_springs(const JointList& joints) const;
  /// Marks the bodies (by index) that other joints of this step hold.
  void mark_held(const State& s, const JointList& joints, std::span<const uint32_t> slot,
                 std::span<uint8_t> held) const;
  /// Where only springs act on a body, a step may begin and end with half a spring impulse (oscillator_step).
  /// Marks these bodies in `sprung`. After `start`.
  void loosen(const JointList& joints, std::span<const uint8_t> held, std::span<uint8_t> sprung, double h);
  /// Applies half a spring impulse of those at their current positions, times `times`.
  void kick(Record8<T>* v, T times, const ThreadTeam& team);
  /// After the bodies have moved, `elapsed` (s) after the start of the step: rotates the impulses of joints
  /// with them.
  void renew(const Record8<T>* moved, Record8<T>* warm, double elapsed, Renewal renewal,
             const ThreadTeam& team);
  /// Softness of joints, for substeps of h.
  static SoftConstraint<double> softness(double h);
  /// Applies springs, before locked rows respond in `bias`.
  void pull(Record8<T>* v, const ThreadTeam& team);
  void bias(Record8<T>* v, const ThreadTeam& team);
  void relax(Record8<T>* v, const ThreadTeam& team);
  /// Stores the start values of the next step, once the bodies of `s` are at their new positions; h: a
  /// substep. Overloaded joints break.
  void store(State& s, const JointList& joints, double h);

 private:
  void count_drives(const JointList& joints);
  void fill_group(size_t group, const State& s, const JointList& joints, const Bodies& bodies, double h);
  void fill_drive(JointGroup<T>& g, int lane, const State& s, const Joint& joint, uint32_t index,
                  const Drive& drive, const JointPlace& at);
  void set_drift(JointGroup<T>& g, int lane, const State& s, const std::array<uint32_t, 2>& held,
                 const Bodies& bodies, const JointPlace& at);
  void fill_gears(const State& s, const JointList& joints);
  /// body(group, lane, drive, its coefficients) for springs that alone act on their bodies.
  template <class Body>
  void each_loose(const JointList& joints, std::span<const uint8_t> held, Body&& body);
  void soften(size_t group, const JointList& joints, double h);
  void prepare(JointGroup<T>& g, const Record8<T>* moved, double elapsed);
  /// The drive of the group for this row.
  JointDrive<T>& drive_of(const JointGroup<T>& g, uint32_t row) {
    return drives_[g.first_drive + static_cast<uint32_t>(std::popcount(g.driven_rows & ((1u << row) - 1)))];
  }

  template <class U>
  using Aligned = std::vector<U, CacheLineAllocator<U>>;
  Aligned<JointGroup<T>> groups_;
  Aligned<JointDrive<T>> drives_;
  std::vector<GearRow<T>> gears_;
  LaneGroups lanes_;
  LaneColouring colouring_;
  std::vector<ConstraintEnds> ends_;
  std::vector<uint32_t> listed_;
  std::vector<uint32_t> place_;     // of joints: group * lanes + lane, or kNoBody
  std::vector<double> coordinate_;  // of the scene's drives at the start of the step
  std::vector<double> rates_;       // 1/s, per body: sum over its springs
  JointPass<T> pass_, relax_;
  uint32_t end_ = 0;
};

}  // namespace truestep::rigid3d
