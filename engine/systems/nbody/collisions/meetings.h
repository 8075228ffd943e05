// What balls that touch at one moment do to each other, and what becomes of it until the step ends: they
// merge, part, or rest against each other (resting_pairs.h) when their flight would be shorter than 1/64 of
// the step.
#pragma once
#include <vector>

#include "engine/core/equations/integrator.h"
#include "engine/systems/nbody/collisions/balls.h"
#include "engine/systems/nbody/collisions/resting_pairs.h"
#include "engine/systems/nbody/nbody_def.h"

namespace truestep::nbody {

/// Of the reach: contact is found so well, and taken as touching ten times farther.
inline constexpr double kTouching = 1e-9;

class Meetings {
 public:
  /// Scratch memory of a step.
  struct Memory {
    std::vector<double> first, still;
    std::vector<Pair> near;
    std::vector<uint8_t> dead;
    MetPairs met;
  };
  /// `fixed`: the method's steps are as long as the scene's.
  Meetings(const CollisionsDef& def, State& s, const StepInput& in, bool fixed, Memory& memory);

  /// Resolves all that touches at this moment (s). `hit`: what was found to touch, also where it has no
  /// speed; `blunt`: nothing parts any more in this step.
  void resolve(double now, Pair hit, bool blunt);
  /// At the end of the step: what rests loses the speed of approach that it has gained and is put back.
  void hold();

 private:
  void gather();
  bool meet(Pair pair, double now, bool blunt);
  void join(Pair pair);
  double least_speed(Pair pair) const;
  void stir(uint32_t i, const Vec3& change, double least);
  void push_apart(double* column, Pair pair, const Vec3& change);
  double apart_at_start(Pair pair) const;

  const CollisionsDef& def_;
  const Balls balls_;
  const StepInput& in_;
  const bool fixed_;
  Memory& w_;
  Pair hit_{};
};

}  // namespace truestep::nbody
