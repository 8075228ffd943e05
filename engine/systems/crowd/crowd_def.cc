#include "engine/systems/crowd/crowd_def.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text/short_number.h"

namespace truestep::crowd {
namespace {

constexpr int64_t kMost = 200'000;
constexpr double kMostNodes = 4e6, kPi = 3.141592653589793;
/// Discs placed at random one after the other jam at an area fraction of 0.547.
constexpr double kFullest = 0.5;

void check_group(const CrowdDef& d, size_t k, const DefTable::Report& report) {
  const GroupDef& g = d.groups[k];
  const std::string at = "/groups/" + std::to_string(k);
  const int ways = (g.goal ? 1 : 0) + (g.heading ? 1 : 0) + (g.goals.empty() ? 0 : 1);
  if (ways != 1) report(at, "a group needs exactly one of goal, goals and heading");
  if (g.heading && !(norm(*g.heading) > 0)) report(at + "/heading", "the heading must not be zero");
  if (!g.goals.empty() && g.goals.size() != g.positions.size())
    report(at + "/goals", "needs as many goals as positions");
  if (g.goal_end && !g.goal) report(at + "/goal_end", "needs a goal, whose other end it is");
  if (g.goal_end && norm(g.goal_half_extents) > 0) {
    report(at + "/goal_end", "a goal is a segment or a box, not both");
  }
  if (d.period > 0 && !g.heading)
    report(at + "/heading", "in a periodic corridor every group needs a heading");
  if (g.leave && g.heading) report(at + "/leave", "a group with a heading never arrives");
  if (g.radius_deviation > g.radius) report(at + "/radius_deviation", "must be at most the radius");
  if (!g.positions.empty()) return;
  const double r = g.radius + g.radius_deviation;
  const double area = 4 * (g.half_extents.x + r) * (g.half_extents.y + r);
  const double discs = static_cast<double>(g.count) * kPi * r * r;
  if (discs > kFullest * area) {
    report(at + "/half_extents", "discs would cover " + short_number(discs / area) +
                                     " of the starting area; up to " + short_number(kFullest) +
                                     " finds room");
  }
}

void check(const CrowdDef& d, const DefTable::Report& report) {
  if (people_of(d) > static_cast<size_t>(kMost)) report("/groups", "more than 200,000 people");
  for (size_t k = 0; k < d.groups.size(); ++k) check_group(d, k, report);
  for (size_t k = 0; k < d.doors.size(); ++k) {
    const std::string at = "/doors/" + std::to_string(k);
    if (d.doors[k].from == d.doors[k].to) report(at + "/to", "a door needs a width");
    for (size_t j = 0; j < k; ++j) {
      if (d.doors[j].id == d.doors[k].id) report(at + "/id", "another door has this id");
    }
  }
  size_t corners = 0;
  for (const WallDef& w : d.walls) corners += w.points.size();
  if (corners > 20'000) report("/walls", "more than 20,000 corners");
  const double reach = 2 * largest_radius(d) + (d.model == Model::orca ? d.neighbour_distance : d.reach);
  if (d.period > 0 && d.period < 2 * reach) {
    report("/period", "must be at least " + short_number(2 * reach) +
                          " m, or people would meet their own neighbours twice");
  }
  if (way_nodes(d) > kMostNodes) report("/grid_spacing", "more than four million nodes to find paths on");
}

Vec3 flat(Vec3 x) {
  x.z = 0;
  return x;
}

const DefTable& wall_table() {
  using D = WallDef;
  static const DefTable t =
      TableOf<D>("a line that nobody crosses")
          .vectors("points", &D::points, "m", any(), {2, 100'000}, "corners in order; z is ignored")
          .required()
          .boolean("closed", &D::closed, "whether the last corner is joined to the first")
          .build();
  return t;
}

const DefTable& door_table() {
  using D = DoorDef;
  static const DefTable t =
      TableOf<D>("a gap in every wall along it, and a line whose crossings are counted")
          .text("id", &D::id, "name in observables")
          .required()
          .vector("from", &D::from, "m", any(), "one jamb")
          .required()
          .vector("to", &D::to, "m", any(),
                  "the other end; from right to left, seen along the line, counts as forward")
          .required()
          .build();
  return t;
}

const DefTable& group_table() {
  using D = GroupDef;
  static const DefTable t =
      TableOf<D>("people with one starting area and one goal")
          .integer("count", &D::count, between(1, kMost), "people, spread at random without overlap")
          .vectors("positions", &D::positions, "m", any(), {0, kMost}, "of everybody, instead of count")
          .vectors("goals", &D::goals, "m", any(), {0, kMost},
                   "one per position, approached in a straight line, not around walls")
          .vector("center", &D::center, "m", any(), "of the starting area")
          .vector("half_extents", &D::half_extents, "m", at_least(0), "of that area")
          .number("speed", &D::speed, "m/s", at_least(0), "mean desired walking speed")
          .number("speed_deviation", &D::speed_deviation, "m/s", at_least(0),
                  "standard deviation of the normal distribution of desired speeds, cut off at two of them "
                  "and at 0")
          .number("radius", &D::radius, "m", at_least(0), "of a person, on average")
          .number("radius_deviation", &D::radius_deviation, "m", at_least(0),
                  "radii are uniform within +- this")
          .number("mass", &D::mass, "kg", above(0), "of a person")
          .vector("velocity", &D::velocity, "m/s", any(), "of everybody at the start")
          .vector("goal", &D::goal, "m", any(), "goal point, centre of a box, or one end of a segment")
          .vector("goal_end", &D::goal_end, "m", any(), "other end of the goal")
          .vector("goal_half_extents", &D::goal_half_extents, "m", at_least(0), "of a box as the goal")
          .vector("heading", &D::heading, "1", any(), "direction to walk in for ever, instead of a goal")
          .boolean("leave", &D::leave, "whether people who arrive are removed and counted")
          .vector("color", &D::color, "1", between(0, 1), "linear red, green, blue")
          .build();
  return t;
}

}  // namespace

size_t people_of(const GroupDef& g) {
  return g.positions.empty() ? static_cast<size_t>(g.count) : g.positions.size();
}

size_t people_of(const CrowdDef& d) {
  size_t n = 0;
  for (const GroupDef& g : d.groups) n += people_of(g);
  return n;
}

double largest_radius(const CrowdDef& d) {
  double r = 0;
  for (const GroupDef& g : d.groups) r = std::max(r, g.radius + g.radius_deviation);
  return r;
}

Vec3 Goal::nearest(const Vec3& x) const {
  if (!(half_extents.x > 0 || half_extents.y > 0)) return nearest_point(line, x);
  const Vec3 low = line.a - half_extents, high = line.a + half_extents;
  return {std::clamp(x.x, low.x, high.x), std::clamp(x.y, low.y, high.y), 0};
}

Goal goal_of(const GroupDef& g) {
  const Vec3 a = flat(g.goal.value_or(Vec3{}));
  return {{a, flat(g.goal_end.value_or(a))}, flat(g.goal_half_extents)};
}

Bounds bounds_of(const CrowdDef& d) {
  constexpr double kHuge = HUGE_VAL;
  Bounds b{{kHuge, kHuge, 0}, {-kHuge, -kHuge, 0}};
  const auto take = [&b](const Vec3& x, const Vec3& half) {
    b.low = {std::min(b.low.x, x.x - half.x), std::min(b.low.y, x.y - half.y), 0};
    b.high = {std::max(b.high.x, x.x + half.x), std::max(b.high.y, x.y + half.y), 0};
  };
  for (const WallDef& w : d.walls) {
    for (const Vec3& p : w.points) take(p, {});
  }
  for (const GroupDef& g : d.groups) {
    if (g.positions.empty()) take(g.center, g.half_extents);
    for (const Vec3& p : g.positions) take(p, {});
    for (const Vec3& p : g.goals) take(p, {});
    if (g.goal) take(*g.goal, g.goal_half_extents);
    if (g.goal_end) take(*g.goal_end, {});
  }
  if (!(b.low.x <= b.high.x)) b = {};
  // Room to walk around obstacles at the rim.
  const double room = 2 * d.clearance + 4 * largest_radius(d);
  b.low -= Vec3{room, room, 0}, b.high += Vec3{room, room, 0};
  return b;
}

double way_spacing(const CrowdDef& d) {
  const bool any_goal =
      std::any_of(d.groups.begin(), d.groups.end(), [](const GroupDef& g) { return g.goal.has_value(); });
  if (d.walls.empty() || !any_goal) return 0;
  if (d.grid_spacing > 0) return d.grid_spacing;
  constexpr double kFinest = 0.1, kNodes = 4e5;
  const Bounds b = bounds_of(d);
  return std::max(kFinest, std::sqrt((b.high.x - b.low.x) * (b.high.y - b.low.y) / kNodes));
}

double way_nodes(const CrowdDef& d) {
  const double h = way_spacing(d);
  if (!(h > 0)) return 0;
  const Bounds b = bounds_of(d);
  return (std::ceil((b.high.x - b.low.x) / h) + 1) * (std::ceil((b.high.y - b.low.y) / h) + 1);
}

const DefTable& crowd_table() {
  using D = CrowdDef;
  static const DefTable t =
      TableOf<D>("pedestrians in the plane who walk to their goals and avoid each other and walls")
          .choice("model", &D::model, {"social_force", "orca"},
                  "forces of repulsion, contact and friction (Helbing, Farkas, Vicsek 2000), or velocities "
                  "that avoid collisions reciprocally (van den Berg, Guy, Lin, Manocha 2011)")
          .objects("groups", &D::groups, group_table(), {1, 100}, "groups of people")
          .required()
          .objects("walls", &D::walls, wall_table(), {0, 10'000}, "lines that nobody crosses")
          .objects("doors", &D::doors, door_table(), {0, 100}, "gaps in walls, where crossings are counted")
          .number("period", &D::period, "m", at_least(0),
                  "length along x, about x = 0, of a periodic corridor; 0: not periodic")
          .number("arrival_distance", &D::arrival_distance, "m", above(0),
                  "from the goal at which a person has arrived")
          .number("relaxation_time", &D::relaxation_time, "s", above(0),
                  "in which a velocity approaches the desired one, and in which people slow down at a goal")
          .number("noise", &D::noise, "rad", between(0, 6.283185307179586),
                  "full angle of the random change of the desired direction every step")
          .number("repulsion", &D::repulsion, "N", at_least(0),
                  "social_force: A, between two people who just touch")
          .number("repulsion_range", &D::repulsion_range, "m", above(0), "social_force: B")
          .number("body_stiffness", &D::body_stiffness, "kg/s^2", at_least(0),
                  "social_force: k, of bodies in contact")
          .number("sliding_friction", &D::sliding_friction, "kg/(m s)", at_least(0),
                  "social_force: kappa, along bodies in contact")
          .number("attention", &D::attention, "1", between(0, 1),
                  "social_force: lambda, weight of people behind; ahead it is 1")
          .number("reach", &D::reach, "m", above(0),
                  "social_force: distance between rims beyond which there is no force")
          .integer("max_substeps", &D::max_substeps, between(1, 1e6),
                   "social_force: of a step; a step that needs more fails")
          .number("horizon", &D::horizon, "s", above(0), "orca: time kept free of collisions with others")
          .number("wall_horizon", &D::wall_horizon, "s", above(0),
                  "orca: time kept free of collisions with walls")
          .number("margin", &D::margin, "m", at_least(0), "orca: gap kept between rims where there is room")
          .number("neighbour_distance", &D::neighbour_distance, "m", above(0),
                  "orca: between rims of people considered, and twice the longest move of a step")
          .integer(
              "max_neighbours", &D::max_neighbours, between(1, 36),
              "orca: nearest people to consider; in a dense crowd considering everybody means standing still")
          .number("max_speed", &D::max_speed, "m/s", above(0),
                  "orca: limit, unless the desired speed is higher")
          .number("clearance", &D::clearance, "m", at_least(0), "that paths keep from walls where possible")
          .number("grid_spacing", &D::grid_spacing, "m", at_least(0),
                  "of the grid for finding paths; 0: automatic")
          .number("lane_width", &D::lane_width, "m", above(0),
                  "of the strip within which lanes.order compares directions")
          .number("density_radius", &D::density_radius, "m", above(0),
                  "of the disc in which density is measured")
          .check(check)
          .build();
  return t;
}

Cost crowd_cost(const void* def) {
  const auto& d = *static_cast<const CrowdDef*>(def);
  const double n = static_cast<double>(people_of(d)), nodes = way_nodes(d);
  double goals = 0;
  for (const GroupDef& g : d.groups) goals += g.goal ? 1 : 0;
  // Measured: orca takes 4 to 5 us per person; social forces 0.6 to 2.3, and several times that in a dense
  // crowd, because of its substeps.
  return {.state_bytes = 120 * n,
          .workspace_bytes = 200 * n + nodes * (10 * goals + 7),
          .elements = n,
          .seconds_per_step = (d.model == Model::orca ? 5e-6 : 4e-6) * n};
}

}  // namespace truestep::crowd
