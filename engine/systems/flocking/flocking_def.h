// What a scene says about a flock; units and bounds are in the table (flocking_def.cc).
#pragma once
#include <optional>
#include <vector>

#include "engine/collision/points/collider_def.h"
#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/outputs.h"

namespace truestep::flocking {

enum class Rule : uint8_t { reynolds, vicsek, cucker_smale };
enum class Sides : uint8_t { open, walls, periodic };
enum class Space : uint8_t { plane, solid };

struct FlockingDef {
  Rule rule = Rule::reynolds;
  Space space = Space::solid;
  Sides sides = Sides::open;
  int64_t count = 200;
  std::vector<Vec3> positions, velocities;
  Vec3 center, half_extents{5, 5, 5};
  std::optional<Vec3> start_center, start_half_extents;
  double speed = 1;
  std::optional<Vec3> heading;

  double separation_radius = 0.5, alignment_radius = 1, cohesion_radius = 1;  // m
  double separation = 4, alignment = 1, cohesion = 0.5;                       // m/s^2, 1/s, 1/s^2
  double view_angle = 6.283185307179586;                                      // rad
  double min_speed = 0.5, max_speed = 2;                                      // m/s
  double max_acceleration = 10, max_turn_rate = 6.283185307179586;            // m/s^2, rad/s
  double wall_margin = 1, wall_strength = 5;                                  // m, m/s^2
  ColliderDefs colliders;
  std::optional<Vec3> goal;
  double goal_strength = 1;  // m/s^2
  int64_t predators = 0;
  double predator_speed = 3, predator_turn_rate = 2;  // m/s, rad/s
  double flight_radius = 3, flight_strength = 10;     // m, m/s^2

  double radius = 1, noise = 0.5;                       // vicsek: m, rad
  double coupling = 1, influence_range = 1, decay = 0;  // cucker_smale: 1/s, m, 1

  double draw_radius = 0.05;
  std::optional<Vec3> color;
};

const DefTable& flocking_table();
const Outputs& flocking_outputs();
Cost flocking_cost(const void* def);
/// Number of rows without the predators, which come last.
size_t boid_count(const FlockingDef& def);
/// m, distance beyond which nobody is a neighbour.
double reach_of(const FlockingDef& def);

}  // namespace truestep::flocking
