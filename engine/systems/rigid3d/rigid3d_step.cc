// A step where most of what is awake touches and turns fast: contact points and normals of the step's start
// are stale after a turn of a few tenths of a radian (a spinning box would stand on corners that have gone
// round), so that the stages run once a substep, and substeps are as many as keep each below a fifth of a
// radian: a flat box on corners that were a third of a radian old sank into the ground and went away. What
// rolls or spins among many that do not turn is left to the step as it is: the search for contacts is a large
// part of what a step costs. What only comes to touch in a step is not cut, but its friction knows how it
// turns (contact_solve3.h).
#include <algorithm>
#include <cmath>

#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::rigid3d {

namespace {
/// rad in a step; contacts of bodies that turn as far, for every body awake.
constexpr double kFastTurn = 0.1, kMost = 1;
/// rad in a substep, at most.
constexpr double kSubstepTurn = 0.2;
}  // namespace

bool Rigid3d::turns_fast(const State& s, uint32_t i, double h) const {
  const BodyKind& k = bodies_.kinds[s.span<uint32_t>(columns::kind)[i]];
  // Where a ball touches does not depend on how it turns.
  if (s.span<uint32_t>(columns::asleep)[i] || k.reach == k.inner) return false;
  return norm2(load3(s.f64(columns::angular_velocity).data(), i)) * (h * h) > kFastTurn * kFastTurn;
}

bool Rigid3d::all_turn_fast(const State& s, size_t turning) const {
  if (turning == 0) return false;
  const auto kind = s.span<uint32_t>(columns::kind), asleep = s.span<uint32_t>(columns::asleep);
  size_t awake = 0;
  for (size_t i = 0; i < kind.size(); ++i) awake += !asleep[i] && bodies_.kinds[kind[i]].moved_by_forces();
  return static_cast<double>(turning) >= kMost * static_cast<double>(awake);
}

bool Rigid3d::contacts_turn_fast(const State& s, double h) const {
  const auto pairs = s.span<uint32_t>(columns::contact_bodies);
  size_t turning = 0;
  for (size_t k = 0; k < pairs.size(); k += 2)
    turning += turns_fast(s, pairs[k], h) || turns_fast(s, pairs[k + 1], h);
  return all_turn_fast(s, turning);
}

bool Rigid3d::contacts_turn_fast(const State& s, std::span<Contact* const> found, double h) const {
  size_t turning = 0;
  for (const Contact* c : found) turning += turns_fast(s, c->a, h) || turns_fast(s, c->b, h);
  return all_turn_fast(s, turning);
}

int Rigid3d::substeps_of_turns(const State& s, double h) const {
  double fastest = 0;
  for (const uint32_t i : s.span<uint32_t>(columns::contact_bodies)) {
    if (turns_fast(s, i, h))
      fastest = std::max(fastest, norm(load3(s.f64(columns::angular_velocity).data(), i)));
  }
  const double most = BucklingWatch::kMostTimes * settings_.substeps;
  return static_cast<int>(std::min(std::ceil(fastest * h / kSubstepTurn), most));
}

void Rigid3d::step(State& s, const StepInput& in) const {
  int& parts = scratch(in).parts;
  parts = 1;
  if (s.f64(columns::substep)[0] > 0 && contacts_turn_fast(s, in.h)) {
    parts = substeps(s, in.h);
    const int wanted = substeps_of_turns(s, in.h);
    if (wanted > parts) change_substeps(s, in.h, parts, wanted), parts = wanted;
  }
  StepInput part = in;
  part.h = in.h / parts;
  for (int k = 0; k < parts; ++k) {
    part.t = in.t + k * part.h;
    StagedSystem::step(s, part);
  }
}

}  // namespace truestep::rigid3d
