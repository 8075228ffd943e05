// Joints of a step: those that hold a moving body, side by side by colour, warm started, and solved before
// the contacts in every pass; gears after them. What they carry is kept in the state from step to step.
#pragma once
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/kernels/joint_drives3.h"
#include "engine/kernels/soft_constraint.h"
#include "engine/rigid/lanes.h"
#include "engine/systems/rigid3d/contacts.h"
#include "engine/systems/rigid3d/solver_gear.h"

namespace truestep::rigid3d {

/// Impulse of a motor without a bound, N s.
inline constexpr double kAnyImpulse = 1e20;

template <class T>
class JointSolver {
 public:
  using W = Wide<T>;
  /// What the step knows of its bodies: slot[i] is body i's place in `scaled`, or kNoBody.
  struct Bodies {
    std::span<const BodyNow> now;
    std::span<const uint32_t> slot;
    std::span<const ScaledBody> scaled;
    size_t moving = 0;
  };
  /// Lists the joints of this step and marks the bodies that they move (slot 0).
  void choose(const State& s, std::span<const BodyNow> now, std::span<uint32_t> slot);
  /// Those of this step, before `fill`.
  std::vector<uint32_t>& listed() { return listed_; }
  /// h: a substep.
  void fill(const State& s, const JointList& joints, const Bodies& bodies, double h, const ThreadTeam& team);
  /// Before the first substep of h: adds to `warm` what the joints carried last.
  void start(const JointList& joints, const Record8<T>* moved, Record8<T>* warm, double h,
             const ThreadTeam& team);
  /// Joints of this step that are springs and nothing else, before `fill`.
  bool has_springs(const JointList& joints) const;
  /// Marks the bodies (by place) that other joints of this step hold.
  void mark_held(const State& s, const JointList& joints, std::span<const uint32_t> slot,
                 std::span<uint8_t> held) const;
  /// Springs act alone on bodies that nothing holds: a step may begin and end with half a pull of theirs
  /// (oscillator_step). Marks in `sprung` where one does. After `start`.
  void loosen(const State& s, const JointList& joints, std::span<const uint8_t> held,
              std::span<uint8_t> sprung, double h);
  /// Half a pull of those where they are now, `times` over.
  void kick(Record8<T>* v, T times, const ThreadTeam& team);
  /// When the bodies have moved, `elapsed` (s) after the step's start: what joints carry turns with them.
  void renew(const Record8<T>* moved, Record8<T>* warm, double elapsed, Renewal renewal,
             const ThreadTeam& team);
  /// Softness of joints, for substeps of h.
  static SoftConstraint<double> softness(double h);
  /// Springs pull, before what is locked answers in `bias`.
  void pull(Record8<T>* v, const ThreadTeam& team);
  void bias(Record8<T>* v, const ThreadTeam& team);
  void relax(Record8<T>* v, const ThreadTeam& team);
  /// What the next step starts from, once the bodies of `s` are where they go; h: a substep. Joints that
  /// carried too much break.
  void store(State& s, const JointList& joints, double h);

 private:
  void count_drives(const JointList& joints);
  void fill_group(size_t group, const State& s, const JointList& joints, const Bodies& bodies, double h);
  void fill_drive(JointGroup<T>& g, int lane, const State& s, const Joint& joint, uint32_t index,
                  const Drive& drive, const JointPlace& at);
  void set_drift(JointGroup<T>& g, int lane, const State& s, const std::array<uint32_t, 2>& held,
                 const Bodies& bodies, const JointPlace& at);
  void fill_gears(const State& s, const JointList& joints);
  void soften(size_t group, const JointList& joints, double h);
  void prepare(JointGroup<T>& g, const Record8<T>* moved, double elapsed);
  /// The group's drive of that row.
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
  std::vector<double> coordinate_;  // of the scene's drives at the step's start
  JointPass<T> pass_, relax_;
  uint32_t end_ = 0;
};

}  // namespace truestep::rigid3d
