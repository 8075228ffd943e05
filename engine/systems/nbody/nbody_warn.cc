// Reasons not to trust the collisions of a step of bodies.
#include "engine/base/text/short_number.h"
#include "engine/systems/nbody/collisions/impacts.h"
#include "engine/systems/nbody/nbody.h"

namespace truestep::nbody {

void Nbody::warn(const State& s, double h, std::vector<Warning>& out) const {
  if (!bodies_.def().collisions) return;
  if (const double left = impact(s, Impact::left_over); left > 0) {
    out.push_back({"collisions.left_over", left, 0,
                   "more bodies touched within a step than it has room for; they only lost their speed of "
                   "approach, or passed: a shorter step would do",
                   h / 8});
  }
  // A leapfrog step of the length 0.2 in these units is off by 0.2^2 / 24 of the pair's energy.
  constexpr double kResolved = 0.2;
  if (const double ratio = impact(s, Impact::largest_ratio); ratio > kResolved) {
    const double dt = h * kResolved / ratio;
    out.push_back({"collisions.step_ratio", ratio, kResolved,
                   "bodies that touch fall faster than steps of this length resolve: dt " +
                       short_number(dt, 2) + " s, or ias15, would do",
                   dt});
  }
}

}  // namespace truestep::nbody
