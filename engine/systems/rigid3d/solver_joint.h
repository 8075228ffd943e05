// Joints of a step: those that hold a moving body, side by side by colour, warm started, and solved before
// the contacts in every pass. What they carry is kept in the state from step to step.
#pragma once
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/kernels/joint_rows3.h"
#include "engine/kernels/soft_constraint.h"
#include "engine/systems/rigid3d/contacts.h"
#include "engine/systems/rigid3d/solver_lanes.h"

namespace truestep {

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
  void fill(const State& s, std::span<const Joint> joints, const Bodies& bodies, const ThreadArena& arena);
  /// Before the first substep of h: adds to `warm` what the joints carried last.
  void start(const Record8<T>* moved, Record8<T>* warm, double h, const ThreadArena& arena);
  /// Before every other: what joints carry turns with their bodies.
  void renew(const Record8<T>* moved, Record8<T>* warm, const ThreadArena& arena);
  void push(Record8<T>* v, const ThreadArena& arena);
  void relax(Record8<T>* v, const ThreadArena& arena);
  /// Impulses for the next step; h: a substep. Joints that carried too much break.
  void store(State& s, std::span<const Joint> joints, double h) const;

 private:
  void fill_group(size_t group, const State& s, std::span<const Joint> joints, const Bodies& bodies);

  std::vector<JointGroup<T>, CacheLineAllocator<JointGroup<T>>> groups_;
  LaneGroups lanes_;
  LaneColouring colouring_;
  std::vector<ConstraintEnds> ends_;
  std::vector<uint32_t> listed_;
  SoftConstraint<double> soft_;
  uint32_t end_ = 0;
};

}  // namespace truestep
