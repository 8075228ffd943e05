// Impulses between pairs of points, some of which respond together with everything tied to them
// (core/equations/impulse_answer.h). With J the impulses on b (the opposite on a), u = v_b - v_a and W J the
// change of u:
//   J = S y,  (give + S W S) y = right,   S = along n n^T + across (1 - n n^T) for every pair,
// symmetric positive semidefinite, solved by conjugate gradients (Saad 2003, algorithm 6.18) with one solve
// of either side's equations per iteration. A rigid link has give 0; a spring solved within the step has give
// 1 and the square roots of its stiffnesses in S.
#pragma once
#include <span>
#include <vector>

#include "engine/core/coupling.h"
#include "engine/core/equations/impulse_answer.h"

namespace truestep {

struct AnsweredPair {
  size_t a, b;    ///< rows
  double wa, wb;  ///< 1/kg
  Vec3 n = {};    ///< unit vector, if along and across differ
  double along = 1, across = 1, give = 0;
  Vec3 right = {};    ///< the right-hand side
  Vec3 given = {};    ///< N s on b, already included in the steps of both sides
  Vec3 impulse = {};  ///< N s on b, out
  Vec3 change = {};   ///< m/s, change of u by all impulses, out
};

class AnsweredPairs {
 public:
  AnsweredPairs(const System& a, const System& b, PointPort columns_a, PointPort columns_b)
      : a_(answers_together(a)), b_(answers_together(b)), columns_a_(columns_a), columns_b_(columns_b) {}

  /// Whether either side responds as a whole.
  bool any() const { return a_ || b_; }
  /// Of both sides together.
  AnswersImpulses::Seconds answer_seconds() const {
    AnswersImpulses::Seconds sum;
    for (const AnswersImpulses* side : {a_, b_ == a_ ? nullptr : b_}) {
      if (!side) continue;
      const auto one = side->answer_seconds();
      sum.first += one.first, sum.again += one.again;
    }
    return sum;
  }

  /// Change of u by the given impulses, to be subtracted to get the motion without them. Builds new matrices
  /// for both sides, which the following calls reuse.
  void answer_given(const CoupledStates& s, const StepInput& in, std::vector<AnsweredPair>& pairs) const;
  /// Solves for the impulses and their effects; nothing moves.
  void solve(const CoupledStates& s, const StepInput& in, std::vector<AnsweredPair>& pairs) const;
  /// Moves both sides by the impulses beyond the given ones: velocities by dv, positions by h dv.
  void move(const CoupledStates& s, const StepInput& in, const std::vector<AnsweredPair>& pairs) const;

 private:
  struct Side;
  struct Sides;
  template <class ImpulseOf>
  void respond(Sides& sides, const StepInput& in, AnswersImpulses::Answer which,
               const std::vector<AnsweredPair>& pairs, ImpulseOf impulse_of) const;
  const AnswersImpulses *a_, *b_;  // null: each point responds for itself
  PointPort columns_a_, columns_b_;
};

}  // namespace truestep
