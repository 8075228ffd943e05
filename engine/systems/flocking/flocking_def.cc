#include "engine/systems/flocking/flocking_def.h"

#include <algorithm>

#include "engine/base/text/short_number.h"

namespace truestep::flocking {
namespace {

constexpr int64_t kMost = 1'000'000, kMostAllPairs = 20'000;
constexpr double kWholeView = 6.283185307179586;

void check_box(const FlockingDef& d, const DefTable::Report& report) {
  if (d.sides == Sides::open) return;
  if (d.rule == Rule::cucker_smale)
    report("/sides", "the rule cucker_smale takes all pairs and needs open sides");
  const bool flat = d.space == Space::plane;
  const Vec3 e = d.half_extents;
  if (!(e.x > 0) || !(e.y > 0) || (!flat && !(e.z > 0))) {
    report("/half_extents", "the box needs an extent along every direction");
  }
  const double least = flat ? std::min(e.x, e.y) : std::min({e.x, e.y, e.z});
  if (d.sides == Sides::periodic && least < reach_of(d)) {
    report("/half_extents", "a periodic box needs half extents of at least the largest radius, " +
                                short_number(reach_of(d)) + " m, or neighbours would count twice");
  }
}

void check(const FlockingDef& d, const DefTable::Report& report) {
  if (!d.velocities.empty() && d.velocities.size() != d.positions.size()) {
    report("/velocities", "needs as many velocities as positions, or none");
  }
  if (d.heading && !(norm(*d.heading) > 0)) report("/heading", "the heading must not be zero");
  if (d.min_speed > d.max_speed) report("/min_speed", "must be at most max_speed");
  if (d.predators > 0 && d.rule != Rule::reynolds) report("/predators", "only for rule reynolds");
  if (d.predators > 0 && d.sides == Sides::periodic) {
    report("/predators", "predators chase in a straight line and need sides open or walls");
  }
  if (d.rule == Rule::cucker_smale && d.decay > 0 && boid_count(d) > static_cast<size_t>(kMostAllPairs)) {
    report("/count", "all pairs of more than " + std::to_string(kMostAllPairs) + " take too long");
  }
  check_box(d, report);
}

}  // namespace

size_t boid_count(const FlockingDef& d) {
  return d.positions.empty() ? static_cast<size_t>(d.count) : d.positions.size();
}

double reach_of(const FlockingDef& d) {
  if (d.rule == Rule::vicsek) return d.radius;
  return std::max({d.separation_radius, d.alignment_radius, d.cohesion_radius});
}

const DefTable& flocking_table() {
  using D = FlockingDef;
  static const DefTable t = [] {
    auto table =
        TableOf<D>("flocks, schools and herds: members that steer by their neighbours")
            .choice(
                "rule", &D::rule, {"reynolds", "vicsek", "cucker_smale"},
                "separation, alignment and cohesion; constant speed along the neighbours' mean heading with "
                "noise, once a step; or velocities that approach each other by distance")
            .choice("space", &D::space, {"plane", "solid"}, "the plane z = 0, or space")
            .choice("sides", &D::sides, {"open", "walls", "periodic"},
                    "no box; a box with walls; or a periodic box")
            .integer("count", &D::count, between(1, kMost), "members, spread at random over the box")
            .vectors("positions", &D::positions, "m", any(), {0, kMost}, "of every member, instead of count")
            .vectors("velocities", &D::velocities, "m/s", any(), {0, kMost},
                     "one per position; absent: speed along heading")
            .vector("center", &D::center, "m", any(), "of the box")
            .vector("half_extents", &D::half_extents, "m", at_least(0), "half edges of the box")
            .vector("start_center", &D::start_center, "m", any(),
                    "centre of the starting region; absent: the whole box")
            .vector("start_half_extents", &D::start_half_extents, "m", at_least(0), "of the starting region")
            .number("speed", &D::speed, "m/s", at_least(0), "at the start; with vicsek always")
            .vector("heading", &D::heading, "1", any(), "of all at the start; absent: random for each")
            .number("separation_radius", &D::separation_radius, "m", above(0),
                    "within which neighbours are avoided")
            .number("alignment_radius", &D::alignment_radius, "m", above(0),
                    "within which velocities are matched")
            .number("cohesion_radius", &D::cohesion_radius, "m", above(0), "within which neighbours attract")
            .number("separation", &D::separation, "m/s^2", at_least(0), "away from a neighbour at contact")
            .number("alignment", &D::alignment, "1/s", at_least(0),
                    "times the difference to the mean velocity")
            .number("cohesion", &D::cohesion, "1/s^2", at_least(0), "times the distance to the mean position")
            .number("view_angle", &D::view_angle, "rad", between(0, kWholeView),
                    "full angle about the heading within which neighbours are seen")
            .number("min_speed", &D::min_speed, "m/s", at_least(0), "lower limit")
            .number("max_speed", &D::max_speed, "m/s", above(0), "upper limit")
            .number("max_acceleration", &D::max_acceleration, "m/s^2", above(0), "of all steering together")
            .number("max_turn_rate", &D::max_turn_rate, "rad/s", above(0), "of the heading")
            .number("wall_margin", &D::wall_margin, "m", above(0),
                    "within which walls and colliders are avoided")
            .number("wall_strength", &D::wall_strength, "m/s^2", at_least(0),
                    "away from a wall or a collider at contact")
            .vector("goal", &D::goal, "m", any(), "point that all steer towards; absent: none")
            .number("goal_strength", &D::goal_strength, "m/s^2", at_least(0), "towards the goal")
            .integer("predators", &D::predators, between(0, 100),
                     "that chase the nearest member; a part of their own")
            .number("predator_speed", &D::predator_speed, "m/s", above(0), "always")
            .number("predator_turn_rate", &D::predator_turn_rate, "rad/s", above(0),
                    "of a predator's heading")
            .number("flight_radius", &D::flight_radius, "m", above(0), "within which predators are fled from")
            .number("flight_strength", &D::flight_strength, "m/s^2", at_least(0),
                    "away from a predator at contact")
            .number("radius", &D::radius, "m", above(0),
                    "vicsek: of the neighbours whose headings are averaged")
            .number("noise", &D::noise, "rad", between(0, kWholeView),
                    "vicsek: full angle of the random change of the heading every step")
            .number("coupling", &D::coupling, "1/s", at_least(0), "cucker_smale: K")
            .number("influence_range", &D::influence_range, "m", above(0),
                    "cucker_smale: sigma of (1 + r^2 / sigma^2)^-decay")
            .number("decay", &D::decay, "1", between(0, 10), "cucker_smale: beta; 0: all weigh the same")
            .number("draw_radius", &D::draw_radius, "m", at_least(0), "size in pictures")
            .vector("color", &D::color, "1", between(0, 1), "linear red, green, blue")
            .check(check);
    add_collider_rows(table, &D::colliders);
    return table.build();
  }();
  return t;
}

Cost flocking_cost(const void* def) {
  const auto& d = *static_cast<const FlockingDef*>(def);
  const double n = static_cast<double>(boid_count(d)), all = n + static_cast<double>(d.predators);
  const bool pairs = d.rule == Rule::cucker_smale;
  // Grid: order, cell, sorted places and velocities, up to four cells; Runge-Kutta: five rows of vectors.
  return {.state_bytes = 48 * all,
          .workspace_bytes = (pairs ? 192 : 96 + (d.colliders.empty() ? 0 : 120)) * n,
          .elements = all,
          .seconds_per_step = pairs ? (d.decay > 0 ? 1.2e-7 * n * n : 2e-8 * n) : 3e-7 * n};
}

}  // namespace truestep::flocking
