// Joints of a step that are balls and nothing more: three rows instead of six, and nothing that a pass does
// not need. The others are solver_joint.h's; both use the same softness and the same columns of the state.
#pragma once
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/kernels/ball_rows3.h"
#include "engine/kernels/soft_constraint.h"
#include "engine/systems/rigid3d/solver_joint.h"

namespace truestep::rigid3d {

template <class T>
class BallSolver {
 public:
  using W = Wide<T>;
  using Bodies = typename JointSolver<T>::Bodies;
  /// Takes what it can solve from `listed`, the joints of this step.
  void take(std::vector<uint32_t>& listed, const State& s, std::span<const Joint> joints,
            std::span<const BodyNow> now);
  /// h: a substep.
  void fill(const State& s, std::span<const Joint> joints, const Bodies& bodies, double h,
            const ThreadTeam& team);
  /// Before the first substep: adds to `warm` what the joints carried last.
  void start(Record8<T>* warm, const ThreadTeam& team);
  /// When the bodies have moved: what joints carry turns with them; `moved` (scaled, in the frames of the
  /// step's start) is what they did in the substep.
  void renew(const Record8<T>* moved, Record8<T>* warm, Renewal renewal, const ThreadTeam& team);
  void bias(Record8<T>* v, const ThreadTeam& team);
  void relax(Record8<T>* v, const ThreadTeam& team);
  /// What the next step starts from, once the bodies of `s` are where they go; h: a substep. Joints that
  /// carried too much break.
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
