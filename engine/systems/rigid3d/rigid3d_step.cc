// A step where most awake bodies touch and rotate fast: contact points and normals from the start of the step
// are stale after a rotation of a few tenths of a radian (a spinning box would stand on corners that have
// moved on). The stages then run once per substep, with enough substeps to keep each below a fifth of a
// radian: a flat box on corners that were a third of a radian old sank into the ground and drifted off.
// Bodies that roll or spin among many that do not rotate are left to the normal step, because the search for
// contacts is a large part of its cost. Steps are not divided for new contacts either.
#include <algorithm>
#include <cmath>

#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::rigid3d {

namespace {
/// rad per step; contacts of bodies that rotate this far, per awake body.
constexpr double kFastTurn = 0.1, kMost = 1;
/// Maximum rotation in a substep, rad.
constexpr double kSubstepTurn = 0.2;
}  // namespace

Rigid3d::Turns::Turns(const State& s, std::span<const BodyKind> of, double step)
    : kinds(of),
      kind(s.span<uint32_t>(columns::kind)),
      asleep(s.span<uint32_t>(columns::asleep)),
      spin(s.f64(columns::angular_velocity).data()),
      h(step) {}

bool Rigid3d::Turns::fast(uint32_t i) const {
  if (!(norm2(load3(spin, i)) * (h * h) > kFastTurn * kFastTurn) || asleep[i]) return false;
  // The contact point of a ball does not depend on its rotation.
  const BodyKind& k = kinds[kind[i]];
  return k.reach != k.inner;
}

bool Rigid3d::contacts_turn_fast(const State& s, double h) const {
  const auto pairs = s.span<uint32_t>(columns::contact_bodies);
  const Turns turns(s, bodies_.kinds, h);
  size_t turning = 0;
  for (size_t k = 0; k < pairs.size(); k += 2) turning += turns.fast(pairs[k]) || turns.fast(pairs[k + 1]);
  if (turning == 0) return false;
  const auto &kind = turns.kind, &asleep = turns.asleep;
  size_t awake = 0;
  const double* rested = s.f64(columns::sleep_timer).data();
  for (size_t i = 0; i < kind.size(); ++i)
    awake += !asleep[i] && bodies_.kinds[kind[i]].moved_by_forces() && !is_led(rested, i);
  return static_cast<double>(turning) >= kMost * static_cast<double>(awake);
}

int Rigid3d::substeps_of_turns(const State& s, double h) const {
  const Turns turns(s, bodies_.kinds, h);
  double fastest = 0;
  for (const uint32_t i : s.span<uint32_t>(columns::contact_bodies)) {
    if (turns.fast(i)) fastest = std::max(fastest, norm(load3(turns.spin, i)));
  }
  const double most = BucklingWatch::kMostTimes * settings_.substeps;
  return static_cast<int>(std::min(std::ceil(fastest * h / kSubstepTurn), most));
}

void Rigid3d::forget_led_rates(State& s) const {
  const auto rested = s.f64(columns::sleep_timer);
  for (size_t i = 0; i < rested.size(); ++i) {
    if (is_led(rested.data(), i)) lead(s, i, {}, {});
  }
}

void Rigid3d::step(State& s, const StepInput& in) const {
  int& parts = scratch(in).parts;
  parts = 1;
  if (all_asleep(s)) return;  // until a command or a coupling wakes something
  if (s.f64(columns::substep)[0] > 0 && contacts_turn_fast(s, in.h)) {
    parts = substeps(s, in.h);
    const int wanted = substeps_of_turns(s, in.h);
    if (wanted > parts) change_substeps(s, in.h, parts, wanted), parts = wanted;
  }
  // What is led moves at one velocity through all of them.
  if (parts > 1) forget_led_rates(s);
  StepInput part = in;
  part.h = in.h / parts;
  for (int k = 0; k < parts; ++k) {
    part.t = in.t + k * part.h;
    StagedSystem::step(s, part);
  }
}

}  // namespace truestep::rigid3d
