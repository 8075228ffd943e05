// The first step on lifts and turntables: what is held by one moving body alone is at rest where it moves
// with that. Loads of a scene are found as if everything were at rest (solver_start.cc), here as if it were
// at rest in the frame of its holder: without, a box on a lift began without loads and leaned before its
// contacts had found them.
#include <algorithm>
#include <cmath>

#include "engine/kernels/rigid/record_math.h"
#include "engine/rigid/islands.h"
#include "engine/systems/rigid3d/solver/solver.h"
#include "engine/systems/rigid3d/solver/solver_carried.h"

namespace truestep::rigid3d {

template <class T>
void ContactSolver<T>::find_lifted(const State& s, std::span<Contact* const> contacts,
                                   std::span<const BodyNow> now, double step) {
  lifted_.clear();
  const auto moves = [&](uint32_t i) { return now[i].part == BodyNow::Part::kinematic; };
  if (std::none_of(listed_.begin(), listed_.end(),
                   [&](uint32_t k) { return moves(contacts[k]->a) || moves(contacts[k]->b); }))
    return;
  const double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data();
  const auto one_motion = [&](uint32_t i, uint32_t j) {
    return i == j || (load3(v, i) == load3(v, j) && load3(w, i) == Vec3{} && load3(w, j) == Vec3{});
  };
  start_islands(island_);
  for (const uint32_t k : listed_) {
    const uint32_t a = slot_[contacts[k]->a], b = slot_[contacts[k]->b];
    if (a != kNoBody && b != kNoBody) link_islands(island_, a, b);
  }
  // Per island, by its lowest body.
  std::vector<uint32_t> holder(body_.size(), kNoBody);
  std::vector<uint8_t> several(body_.size(), 0);
  for (const uint32_t k : listed_) {
    const uint32_t a = contacts[k]->a, b = contacts[k]->b;
    if (slot_[a] != kNoBody && slot_[b] != kNoBody) continue;
    const uint32_t island = island_of(island_, slot_[slot_[a] != kNoBody ? a : b]);
    const uint32_t holds = slot_[a] != kNoBody ? b : a;
    if (holder[island] == kNoBody) holder[island] = holds;
    several[island] |= !one_motion(holder[island], holds);
  }
  lifted_.assign(body_.size(), {});
  for (uint32_t k = 0; k < body_.size(); ++k) {
    const uint32_t island = island_of(island_, k), by = holder[island];
    if (by == kNoBody || several[island] || !moves(by)) continue;
    const BodyNow& body = now[body_[k]];
    const Vec3 spin = load3(w, by), arm = body.at.position - now[by].at.position, &m = moments_[k];
    // At the start of the step: velocities of what is led are the means of the step.
    const Vec3 rate = led_rate(s, by, arm),
               linear = (load3(v, by) + cross(spin, arm) - rate * (0.5 * step)) / scaled_[k].root;
    const Vec3 own = body.at.rotation.apply_inverse(spin);
    lifted_[k] = {{T(linear.x), T(linear.y), T(linear.z), T(own.x * std::sqrt(m.x)),
                   T(own.y * std::sqrt(m.y)), T(own.z * std::sqrt(m.z)), 0, 0}};
  }
}

template <class T>
void ContactSolver<T>::lift(T times) {
  for (size_t k = 0; k < lifted_.size(); ++k) records::add_times(start_[k], times, lifted_[k]);
}

template void ContactSolver<float>::find_lifted(const State&, std::span<Contact* const>,
                                                std::span<const BodyNow>, double);
template void ContactSolver<double>::find_lifted(const State&, std::span<Contact* const>,
                                                 std::span<const BodyNow>, double);
template void ContactSolver<float>::lift(float);
template void ContactSolver<double>::lift(double);

}  // namespace truestep::rigid3d
