// Purely spherical joints of a step: three rows instead of six, and no data that a pass does not need. The
// others are in solver_joint.h; both use the same softness and the same columns of the state.
#pragma once
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/kernels/rigid/ball_rows3.h"
#include "engine/kernels/rigid/soft_constraint.h"
#include "engine/systems/rigid3d/solver/solver_joint.h"

namespace truestep::rigid3d {

template <class T>
class BallSolver {
 public:
  using W = Wide<T>;
  using Bodies = typename JointSolver<T>::Bodies;
  /// Takes the joints that it can solve from `listed`, the joints of this step.
  void take(std::vector<uint32_t>& listed, const State& s, std::span<const Joint> joints,
            std::span<const BodyNow> now);
  /// h: a substep.
  void fill(const State& s, std::span<const Joint> joints, const Bodies& bodies, double h,
            const ThreadTeam& team);
  /// Before the first substep: adds the last impulses of the joints to `warm`.
  void start(Record8<T>* warm, const ThreadTeam& team);
  /// After the bodies have moved: rotates the impulses of the joints with them; `moved` (scaled, in the
  /// frames at the start of the step) is the motion in the substep.
  void renew(const Record8<T>* moved, Record8<T>* warm, Renewal renewal, const ThreadTeam& team);
  void bias(Record8<T>* v, const ThreadTeam& team);
  void relax(Record8<T>* v, const ThreadTeam& team);
  /// Stores the start values of the next step, once the bodies of `s` are at their new positions; h: a
  /// substep. Overloaded joints break.
  void store(State& s, std::span<const Joint> joints, double h) const;

 private:
  struct Unscaled {
    T root, turn[9];  // 1/sqrt(m); S by rows
  };
  void fill_group(size_t group, const State& s, std::span<const Joint> joints, const Bodies& bodies,
                  double h);

  template <class U>
  using Aligned = std::vector<U, CacheLineAllocator<U>>;
  Aligned<BallGroup<T>> groups_;
  Aligned<Record8<T>> moved_;  // m and rad in the world, in the last substep
  std::vector<Unscaled> unscaled_;
  LaneGroups lanes_;
  LaneColouring colouring_;
  std::vector<ConstraintEnds> ends_;
  std::vector<uint32_t> listed_;
  JointPass<T> pass_, relax_;
  uint32_t end_ = 0;
};

}  // namespace truestep::rigid3d
