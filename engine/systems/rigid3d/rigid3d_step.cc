// A step where most of what is awake touches and turns fast: contact points and normals of the step's start
// are stale after a turn of a few tenths of a radian (a spinning box would stand on corners that have gone
// round), so that the stages run once a substep. What rolls or spins among many that do not turn is left to
// the step as it is: the search for contacts is a large part of what a step costs.
#include <cmath>

#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::rigid3d {

namespace {
/// rad in a step; contacts of bodies that turn as far, for every body awake.
constexpr double kFastTurn = 0.1, kMost = 1;
}  // namespace

bool Rigid3d::contacts_turn_fast(const State& s, double h) const {
  const auto pairs = s.span<uint32_t>(columns::contact_bodies);
  const auto kind = s.span<uint32_t>(columns::kind), asleep = s.span<uint32_t>(columns::asleep);
  const double* w = s.f64(columns::angular_velocity).data();
  const auto fast = [&](uint32_t i) {
    const BodyKind& k = bodies_.kinds[kind[i]];
    // Balls meet others where they do however they turn.
    if (asleep[i] || k.reach == k.inner) return false;
    return norm2(load3(w, i)) * (h * h) > kFastTurn * kFastTurn;
  };
  size_t turning = 0, awake = 0;
  for (size_t k = 0; k < pairs.size(); k += 2) turning += fast(pairs[k]) || fast(pairs[k + 1]);
  if (turning == 0) return false;
  for (size_t i = 0; i < kind.size(); ++i) awake += !asleep[i] && bodies_.kinds[kind[i]].moved_by_forces();
  return static_cast<double>(turning) >= kMost * static_cast<double>(awake);
}

void Rigid3d::step(State& s, const StepInput& in) const {
  int& parts = scratch(in).parts;
  parts = 1;
  const double substep = s.f64(columns::substep)[0];
  if (substep > 0 && contacts_turn_fast(s, in.h)) parts = static_cast<int>(std::lround(in.h / substep));
  StepInput part = in;
  part.h = in.h / parts;
  for (int k = 0; k < parts; ++k) {
    part.t = in.t + k * part.h;
    StagedSystem::step(s, part);
  }
}

}  // namespace truestep::rigid3d
