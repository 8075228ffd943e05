// How many small steps a scene's loads need. Contacts resist tilts like springs whose rate w the small steps
// bound, so that a column taller than some length buckles under its own weight (Greenhill 1881). With the
// trial shape theta(s) = s (2 - s), s = z / height, of an island's tilts
//   Q = sum over contacts of k (theta_b - theta_a)^2 / sum over bodies of m g integral_0^z theta^2
// is the Rayleigh quotient of stiffness and load: below 1 it buckles. k is what two points at arms r make
// about their middle, and grows with the square of the small steps. Only islands in which every body stands
// on one other count: courses that overlap hold one another upright, and what falls does not buckle.
// What lies on much lighter bodies is carried through them: the sweeps pass a load on by shares of
// m_light / m_heavy, so that they need more small steps, too. Counted is a light body by the load that it
// carries in its own weights, as far as a single body of its island is that much heavier; where bodies hit,
// before any load is known, by the ratio of the masses alone. What hangs in a joint, as a drum that turns on
// its axle does, lies on nothing.
#pragma once
#include <cmath>
#include <vector>

#include "engine/systems/rigid2d/columns.h"
#include "engine/systems/rigid2d/pairs.h"

namespace truestep::rigid2d {

/// Chooses the small steps of a step from the loads of the last one and from what is about to hit.
class SmallSteps {
 public:
  static constexpr int kMostTimes = 6;
  struct Usual {
    int least, now;  ///< small steps that the scene asks for, and of the last step
    double h;        ///< s, of the last step's
    double rate;     ///< 1/s, angular frequency of contacts in them; 0: it does not follow
    bool looks;      ///< at columns, whose modes are slow: not in every step
  };
  /// At least `least`, at most kMostTimes as many.
  int wanted(const Model& model, const State& s, const Pairs& pairs, const Usual& usual);
  /// Of the last call: heavy bodies touch light ones, so that a blow may follow soon after a blow.
  bool uneven() const { return uneven_; }

 private:
  struct Island {
    double low = 0, high = 0, stiffness = 0, load = 0;
    double heaviest = 0, lightest = HUGE_VAL;
    uint32_t bodies = 0, bearings = 0;
    bool stands = false;  ///< on what does not move
  };
  void find_islands(const Model& model, const State& s, const Pairs& pairs);
  double largest_burden(const Model& model, const State& s, const Pairs& pairs, double h);
  double least_quotient(const Model& model, const State& s, double rate);
  bool uneven_ = false;
  std::vector<uint32_t> parent_;
  std::vector<Island> island_;
};

}  // namespace truestep::rigid2d
