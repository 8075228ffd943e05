// Number of substeps that the loads of a scene need. Contacts resist tilting like springs whose rate w is
// limited by the substeps, and a column above some length buckles under its own weight (Greenhill 1881).
// With the trial shape theta(s) = s (2 - s), s = z / height, for the tilts of an island
//   Q = sum over contacts of k (theta_b - theta_a)^2 / sum over bodies of m g integral_0^z theta^2
// is the Rayleigh quotient of stiffness and load: below 1 it buckles. k is the tilting stiffness of two
// points at arms r about their middle, and grows with the square of the substeps. Only islands in which
// every body stands on one other count: overlapping courses hold one another upright, and falling bodies do
// not buckle. Heavy bodies on much lighter ones are carried through these: a sweep passes on a load in
// fractions of m_light / m_heavy and needs more substeps, too. A light body is judged by the load that it
// carries in multiples of its own weight, as far as one body of its island is that much heavier; on impact
// and at the start, before any load is known, by the mass ratio alone. A body held by a joint, such as a drum
// on its axle, does not rest on another.
#pragma once
#include <cmath>
#include <vector>

#include "engine/systems/rigid2d/columns.h"
#include "engine/systems/rigid2d/pairs.h"

namespace truestep::rigid2d {

/// Chooses the substeps of a step from the loads of the last one and from imminent impacts.
class Substeps {
 public:
  static constexpr int kMostTimes = 6;
  struct Usual {
    int least, now;  ///< the scene's minimum, and the number in the last step
    double h;        ///< s, length of the last substep
    double rate;     ///< 1/s, angular frequency of contacts in them; 0: independent of them
    bool looks;      ///< checks columns, whose modes are slow: not in every step
  };
  /// At least `least`, at most kMostTimes as many.
  int wanted(const Model& model, const State& s, const Pairs& pairs, const Usual& usual);
  /// After the last call: heavy bodies touch light ones, and another impact may follow soon.
  bool uneven() const { return uneven_; }

 private:
  struct Island {
    double low = 0, high = 0, stiffness = 0, load = 0;
    double heaviest = 0, lightest = HUGE_VAL;
    uint32_t bodies = 0, bearings = 0;
    bool stands = false;  ///< on a body that does not move
  };
  void find_islands(const Model& model, const State& s, const Pairs& pairs);
  double largest_burden(const Model& model, const State& s, const Pairs& pairs, double h);
  double least_quotient(const Model& model, const State& s, double rate);
  bool uneven_ = false;
  std::vector<uint32_t> parent_;
  std::vector<Island> island_;
};

}  // namespace truestep::rigid2d
