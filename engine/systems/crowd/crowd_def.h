// What a scene says about a crowd; units and bounds are in the table (crowd_def.cc).
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/outputs.h"
#include "engine/kernels/crowd/segment.h"

namespace truestep::crowd {

enum class Model : uint8_t { social_force, orca };

struct WallDef {
  std::vector<Vec3> points;
  bool closed = false;
};
struct DoorDef {
  std::string id;
  Vec3 from, to;
};
struct GroupDef {
  int64_t count = 50;
  std::vector<Vec3> positions, goals;
  Vec3 center, half_extents{5, 5, 0};
  double speed = 1.34, speed_deviation = 0;   // m/s
  double radius = 0.3, radius_deviation = 0;  // m
  double mass = 80;                           // kg
  Vec3 velocity;
  std::optional<Vec3> goal, goal_end, heading;
  Vec3 goal_half_extents;
  bool leave = false;
  std::optional<Vec3> color;
};

struct CrowdDef {
  Model model = Model::social_force;
  std::vector<GroupDef> groups;
  std::vector<WallDef> walls;
  std::vector<DoorDef> doors;
  double period = 0;  // m along x, 0: none
  double arrival_distance = 0.3;
  double relaxation_time = 0.5;
  double noise = 0;  // rad

  double repulsion = 2000, repulsion_range = 0.08;          // N, m
  double body_stiffness = 1.2e5, sliding_friction = 2.4e5;  // kg/s^2, kg/(m s)
  double attention = 1;                                     // lambda
  double reach = 1.2;                                       // m between the rims
  int64_t max_substeps = 1000;

  double horizon = 2, wall_horizon = 0.1;  // s
  double margin = 0.1;                     // m
  double neighbour_distance = 5;           // m
  int64_t max_neighbours = 6;
  double max_speed = 2;  // m/s

  double clearance = 0.4;     // m
  double grid_spacing = 0;    // m, 0: chosen
  double lane_width = 0.8;    // m
  double density_radius = 1;  // m
};

const DefTable& crowd_table();
const Outputs& crowd_outputs();
Cost crowd_cost(const void* def);

/// People of a group at the start.
size_t people_of(const GroupDef& group);
size_t people_of(const CrowdDef& def);
/// Largest possible radius, m.
double largest_radius(const CrowdDef& def);

/// A group's destination: a point, a segment or an axis-aligned box.
struct Goal {
  Segment line;       ///< a = b: a point
  Vec3 half_extents;  ///< of the box about a; zero: none
  Vec3 nearest(const Vec3& x) const;
};
Goal goal_of(const GroupDef& group);
/// Spacing of the navigation grid, m; 0 when no walls are in the way.
double way_spacing(const CrowdDef& def);
/// Nodes of that grid.
double way_nodes(const CrowdDef& def);
/// Corners of the region covered by walls, starts and goals, m.
struct Bounds {
  Vec3 low, high;
};
Bounds bounds_of(const CrowdDef& def);

}  // namespace truestep::crowd
