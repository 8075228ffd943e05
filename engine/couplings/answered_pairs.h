// Impulses between pairs of points of which some answer together with all that is tied to them
// (core/impulse_answer.h). With J the impulses on b (the opposite on a), u = v_b - v_a and W J the change of
// u:
//   J = S y,  (give + S W S) y = right,   S = along n n^T + across (1 - n n^T) for every pair,
// symmetric and not negative, by conjugate gradients (Saad 2003, algorithm 6.18) with one solution of either
// side's equations an iteration. A rigid link has give 0, a spring that is solved for within the step give 1
// and the roots of its stiffnesses in S.
#pragma once
#include <span>
#include <vector>

#include "engine/core/coupling.h"
#include "engine/core/impulse_answer.h"

namespace truestep {

struct AnsweredPair {
  size_t a, b;    ///< rows
  double wa, wb;  ///< 1/kg
  Vec3 n = {};    ///< unit where along and across differ
  double along = 1, across = 1, give = 0;
  Vec3 right = {};    ///< what is asked for
  Vec3 given = {};    ///< N s on b, that both sides' steps have taken in already
  Vec3 impulse = {};  ///< N s on b, out
  Vec3 change = {};   ///< m/s of u by all impulses, out
};

class AnsweredPairs {
 public:
  AnsweredPairs(const System& a, const System& b, PointPort columns_a, PointPort columns_b)
      : a_(answers_together(a)), b_(answers_together(b)), columns_a_(columns_a), columns_b_(columns_b) {}

  /// Whether any of the two sides answers as a whole.
  bool any() const { return a_ || b_; }

  /// Change of u by the impulses that are given: what to take off for places as they were without them. A new
  /// matrix for both sides, which the calls that follow go on with.
  void answer_given(const CoupledStates& s, const StepInput& in, std::vector<AnsweredPair>& pairs) const;
  /// Solves for the impulses, and what they change; nothing moves.
  void solve(const CoupledStates& s, const StepInput& in, std::vector<AnsweredPair>& pairs) const;
  /// Moves both sides by what the impulses have beyond those that are given: velocities by dv, places by h
  /// dv.
  void move(const CoupledStates& s, const StepInput& in, const std::vector<AnsweredPair>& pairs) const;

 private:
  struct Side;
  struct Sides;
  template <class ImpulseOf>
  void respond(Sides& sides, const StepInput& in, AnswersImpulses::Answer which,
               const std::vector<AnsweredPair>& pairs, ImpulseOf impulse_of) const;
  const AnswersImpulses *a_, *b_;  // null: each point for itself
  PointPort columns_a_, columns_b_;
};

}  // namespace truestep
