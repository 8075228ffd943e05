// Initial impulses of a scene. Substeps carry loads on from the previous one; the first has none, and a sweep
// passes a load on by only a course or two: a tall structure would sink before its lowest contacts felt its
// top. Gravity loads are therefore passed down once, from the highest body to the lowest (bearing.h): exact
// for stacked boxes. Sweeps with all bodies treated as at rest add the loads of leaning bodies, wedges and
// arches. If everything is then supported, contacts start with offsets equal to their yields under these
// loads.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/kernels/rigid/bearing.h"
#include "engine/kernels/rigid/record_math.h"
#include "engine/rigid/islands.h"
#include "engine/systems/rigid3d/solver/solver.h"

namespace truestep::rigid3d {

namespace {

/// Sweeps for the initial loads of a scene, and the number of groups of contacts that they may process in
/// all.
constexpr size_t kLoadSweeps = 2000, kLoadGroups = 200'000;
/// Contacts steeper than this (cosine between normal and vertical) carry nothing.
constexpr double kBears = 0.3;
/// Largest offset at the start, as a fraction of the smaller body's reach: loaded springs store energy.
constexpr double kMostStart = 0.02;
/// Multiple of the scalar's epsilon by which offsets stay below the yields: with offsets that are larger by
/// rounding bodies would be lifted, by a nanometre in single precision.
constexpr double kBelowYield = 32;

}  // namespace

template <class T>
void ContactSolver<T>::list_bearings(std::span<Contact* const> contacts, std::span<const BodyNow> now,
                                     const Vec3& up) {
  bearings_.clear();
  const auto end = static_cast<uint32_t>(body_.size());
  for (size_t k = 0; k < contact_lanes_.count; ++k) {
    for (int lane = 0; lane < W::kLanes; ++lane) {
      const uint32_t m = contact_lanes_.member[k * W::kLanes + lane];
      if (m == kNoBody) continue;
      const Contact& c = *contacts[m];
      const double lean = dot(up, c.manifold.normal);
      const uint32_t upper = slot_[lean > 0 ? c.b : c.a], lower = slot_[lean > 0 ? c.a : c.b];
      if (upper == kNoBody || upper >= end || std::abs(lean) < kBears) continue;
      const double height = dot(up, now[body_[upper]].at.position);
      bearings_.push_back({upper, lower, static_cast<uint32_t>(k), lane, m, std::abs(lean), height});
    }
  }
  std::sort(bearings_.begin(), bearings_.end(), [](const Bearing& a, const Bearing& b) {
    if (a.height != b.height) return a.height > b.height;
    return a.upper != b.upper ? a.upper < b.upper : a.contact < b.contact;
  });
}

template <class T>
void ContactSolver<T>::hand_down_loads(std::span<Contact* const> contacts, std::span<const BodyNow> now) {
  Vec3 pull;
  for (size_t i = 0; i < body_.size() && pull == Vec3{}; ++i) {
    pull = Vec3{double(change_[i].x[0]), double(change_[i].x[1]), double(change_[i].x[2])};
  }
  if (pull == Vec3{}) return;
  const Vec3 up = normalized(pull) * -1.0;
  const Vec3 across = normalized(cross(up, std::abs(up.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})),
             beside = cross(up, across);
  list_bearings(contacts, now, up);
  // N s of a substep, and its moments across the vertical about the body's centre.
  struct Load {
    double force = 0, x = 0, y = 0;
  };
  std::vector<Load> loads(body_.size());
  for (size_t i = 0; i < body_.size(); ++i) {
    const Vec3 g{double(change_[i].x[0]), double(change_[i].x[1]), double(change_[i].x[2])};
    loads[i].force = -dot(g, up) / scaled_[i].root;
  }
  std::vector<BearingPoint> points;
  for (size_t first = 0, last = 0; first < bearings_.size(); first = last) {
    const uint32_t upper = bearings_[first].upper;
    const Vec3 centre = now[body_[upper]].at.position;
    points.clear();
    while (last < bearings_.size() && bearings_[last].upper == upper) {
      const Bearing& b = bearings_[last++];
      const Manifold& m = contacts[b.contact]->manifold;
      for (int p = 0; p < m.count; ++p) {
        const Vec3 r = m.points[p].position - centre;
        points.push_back({dot(r, across), dot(r, beside), b.lean});
      }
    }
    const Load& load = loads[upper];
    if (!(load.force > 0)) continue;
    share_load(points, load.force, load.x, load.y);
    size_t next = 0;
    for (size_t k = first; k < last; ++k) {
      const Bearing& b = bearings_[k];
      const Manifold& m = contacts[b.contact]->manifold;
      for (int p = 0; p < m.count; ++p, ++next) {
        groups_[b.group].place[p].impulse.set(b.lane, T(points[next].force));
        if (b.lower == kNoBody || b.lower >= body_.size()) continue;
        const double force = points[next].force * b.lean;
        const Vec3 r = m.points[p].position - now[body_[b.lower]].at.position;
        Load& under = loads[b.lower];
        under.force += force, under.x += force * dot(r, across), under.y += force * dot(r, beside);
      }
    }
  }
}

template <class T>
void ContactSolver<T>::find_resting() {
  /// Fraction of the velocity change by forces that may remain in a supported body, and multiple of it at
  /// which the body may already move.
  constexpr double kHeld = 0.05, kStill = 2;
  const auto size2 = [](const Record8<T>& r) {
    double sum = 0;
    for (int e = 0; e < 6; ++e) sum += double(r.x[e]) * double(r.x[e]);
    return sum;
  };
  start_islands(island_);
  for (size_t g = 0; g < contact_lanes_.count; ++g) {
    for (int lane = 0; lane < W::kLanes; ++lane) {
      const uint32_t a = groups_[g].a[lane], b = groups_[g].b[lane];
      if (a < island_.size() && b < island_.size()) link_islands(island_, a, b);
    }
  }
  for (size_t i = 0; i < body_.size(); ++i) {
    const double pull = size2(change_[i]);
    Record8<T> v = velocity_[i];
    if (!lifted_.empty()) records::add_times(v, T(-1), lifted_[i]);
    parts_[i] = size2(start_[i]) <= kHeld * kHeld * pull && size2(v) <= kStill * kStill * pull;
  }
  spread_minimum<uint8_t>(island_, {parts_.data(), island_.size()});
}

template <class T>
void ContactSolver<T>::drop_loads_that_drive() {
  constexpr double kRounded = 1 + 1e-4;
  std::vector<double> left(body_.size()), free(body_.size());
  const auto add = [](double& sum, const Record8<T>& r) {
    for (int e = 0; e < 6; ++e) sum += double(r.x[e]) * double(r.x[e]);
  };
  for (uint32_t i = 0; i < body_.size(); ++i) {
    const uint32_t island = island_of(island_, i);
    add(left[island], start_[i]), add(free[island], change_[i]);
  }
  for (size_t k = 0; k < contact_lanes_.count; ++k) {
    ContactGroup<T>& g = groups_[k];
    for (int lane = 0; lane < W::kLanes; ++lane) {
      const uint32_t body = std::min(g.a[lane], g.b[lane]);
      if (body >= body_.size()) continue;
      const uint32_t island = island_of(island_, body);
      if (left[island] <= kRounded * free[island]) continue;
      for (int p = 0; p < g.points; ++p) g.place[p].impulse.set(lane, 0);
      for (int t = 0; t < 2; ++t) g.slide[t].set(lane, 0), g.roll[t].set(lane, 0);
      g.twist.set(lane, 0);
    }
  }
}

template <class T>
void ContactSolver<T>::find_loads(const State& s, std::span<const BodyKind> kinds,
                                  std::span<Contact* const> contacts, std::span<const BodyNow> now,
                                  const SolverSettings& settings, double step) {
  const auto end = static_cast<uint32_t>(body_.size());
  const double h = step / settings.substeps;
  ContactPass<T> pass{};
  pass.inverse_h = T(1 / h);
  // As if everything were at rest: velocities are what gravity adds in a substep and contacts remove.
  start_.assign(change_.begin(), change_.end());
  find_lifted(s, contacts, now, step), lift(T(1));
  hand_down_loads(contacts, now);
  each_colour(contact_lanes_, groups_, team_,
              [&](ContactGroup<T>& g) { apply_contacts(g, start_.data(), end); });
  const size_t sweeps = std::min(kLoadSweeps, kLoadGroups / std::max<size_t>(contact_lanes_.count, 1));
  for (size_t k = 0; k < sweeps; ++k) {
    each_colour(contact_lanes_, groups_, team_, k % 2 == 0 ? ColourOrder::forth : ColourOrder::back,
                [&](ContactGroup<T>& g) {
                  solve_contacts<ContactSolve::relax>(g, start_.data(), displacement_.data(), end, pass);
                });
  }
  lift(T(-1));
  find_resting();
  drop_loads_that_drive();
  const auto kind = s.span<uint32_t>(columns::kind);
  const double gives_way = (1 - kBelowYield * std::numeric_limits<T>::epsilon()) *
                           penetration_offset_at_rest(penetration_offset_rule(settings, step));
  for (size_t k = 0; k < contact_lanes_.count; ++k) {
    ContactGroup<T>& g = groups_[k];
    for (int lane = 0; lane < W::kLanes; ++lane) {
      const uint32_t m = contact_lanes_.member[k * W::kLanes + lane];
      if (m == kNoBody) continue;
      const uint32_t body = std::min(g.a[lane], g.b[lane]);
      if (body < end && !parts_[body]) continue;
      // Each point yields by its own load.
      double load = 0, given = 0;
      for (int p = 0; p < g.points; ++p) {
        const double point = g.place[p].impulse[lane], inverse = g.point_inverse[p][lane];
        if (inverse > 0) load += point, given += point * point / inverse;
      }
      double smallest = HUGE_VAL;
      for (const uint32_t i : {contacts[m]->a, contacts[m]->b}) {
        if (slot_[i] != kNoBody) smallest = std::min(smallest, kinds[kind[i]].reach);
      }
      Contact& c = *contacts[m];
      const double mean = load > 0 ? gives_way * given / load : 0;
      const double share = mean > kMostStart * smallest ? kMostStart * smallest / mean : 1;
      c.penetration_offset = share * mean;
      for (int p = 0; p < g.points; ++p) {
        // The yield of each point: one offset for all would lift the points with less load.
        const double point = g.place[p].impulse[lane], inverse = g.point_inverse[p][lane];
        if (inverse > 0) c.uneven[p] = share * gives_way * point / inverse - c.penetration_offset;
        const T separation = g.place[p].separation_at_start[lane] - T(c.penetration_offset + c.uneven[p]);
        g.place[p].separation_at_start.set(lane, separation), g.place[p].separation.set(lane, separation);
      }
    }
  }
}

template <class T>
void ContactSolver<T>::find_first_loads(const State& s, std::span<const BodyKind> kinds,
                                        const JointList& joints, std::span<Contact* const> contacts,
                                        std::span<const BodyNow> now, const ForceChange& change,
                                        const SolverSettings& settings, const StepInput& in) {
  choose_bodies(s, kinds, contacts, now);
  if (body_.empty()) return;
  const auto gathering = team_.gather(in.arena);
  fill_rows(s, kinds, joints, contacts, now, change, settings, in);
  hand_down_loads(contacts, now);
  for (size_t k = 0; k < contact_lanes_.count; ++k) {
    for (int lane = 0; lane < W::kLanes; ++lane) {
      const uint32_t m = contact_lanes_.member[k * W::kLanes + lane];
      if (m == kNoBody) continue;
      Contact& c = *contacts[m];
      for (int p = 0; p < c.manifold.count; ++p) c.impulse[p] = groups_[k].place[p].impulse[lane];
    }
  }
}

template void ContactSolver<float>::find_loads(const State&, std::span<const BodyKind>,
                                               std::span<Contact* const>, std::span<const BodyNow>,
                                               const SolverSettings&, double);
template void ContactSolver<double>::find_loads(const State&, std::span<const BodyKind>,
                                                std::span<Contact* const>, std::span<const BodyNow>,
                                                const SolverSettings&, double);

template void ContactSolver<float>::find_first_loads(const State&, std::span<const BodyKind>,
                                                     const JointList&, std::span<Contact* const>,
                                                     std::span<const BodyNow>, const ForceChange&,
                                                     const SolverSettings&, const StepInput&);
template void ContactSolver<double>::find_first_loads(const State&, std::span<const BodyKind>,
                                                      const JointList&, std::span<Contact* const>,
                                                      std::span<const BodyNow>, const ForceChange&,
                                                      const SolverSettings&, const StepInput&);
}  // namespace truestep::rigid3d
