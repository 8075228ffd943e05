// Parameters of the system type "mass_spring": points, springs of three families (structural, shear,
// bending), pins, air and damping. The points come from exactly one of five shapes.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/collision/points/collider_def.h"
#include "engine/core/def/resolution.h"
#include "engine/core/def/shape_def.h"
#include "engine/core/equations/integrator_def.h"
#include "engine/core/outputs.h"

namespace truestep::mass_spring {

struct FreeSpring {
  int64_t a = 0, b = 0;
  std::optional<double> stiffness{}, rest_length{};
};

struct FreeShape {
  std::vector<Vec3> points{};      // m
  std::vector<Vec3> velocities{};  // m/s, one per point or none
  std::vector<double> masses{};    // kg, one per point or none
  std::vector<FreeSpring> springs{};
};

struct MassSpringDef : IntegratorParams {
  std::optional<RopeShape> rope;
  std::optional<HairShape> hair;
  std::optional<ClothGridShape> cloth_grid;
  std::optional<MeshShape> mesh;
  std::optional<FreeShape> free;

  double mass = 0.01;             // kg per point
  std::optional<double> density;  // kg/m or kg/m^2, instead of mass
  double stiffness = 1000;        // N/m
  double shear_stiffness = 500;
  double bending_stiffness = 0;
  double bending_rigidity = 0;   // N m^2, EI of a rope or hair
  double flexural_rigidity = 0;  // N m, D of a cloth grid
  double rest_scale = 1;
  double damping = 0;           // N s/m per point
  double internal_damping = 0;  // N s/m per spring
  Vec3 velocity;                // m/s, initial
  std::vector<int64_t> pins;
  std::vector<std::string> pinned;
  std::optional<Vec3> wind;  // m/s
  double gust = 0, gust_period = 2;
  double air_density = 1.2, drag_coefficient = 1.2;
  double thickness = 0.01;  // m
  std::optional<Vec3> color;
  double restitution = 0;
  std::optional<double> friction;
  ColliderDefs colliders;
};

/// The table that parser, schema and documentation read.
const DefTable& mass_spring_table();
/// The outputs of the system.
const Outputs& mass_spring_outputs();
/// Refinement: counts of links and points for the same object.
const Resolution& mass_spring_resolution();
/// Numbers of points and springs of the def's shape, from counts alone (an upper bound for meshes).
struct MassSpringCounts {
  double points = 0, springs = 0, triangles = 0;
};
MassSpringCounts mass_spring_counts(const MassSpringDef& def);
/// Names that "pinned" accepts for the def's shape.
std::vector<std::string> pin_names(const MassSpringDef& def);

}  // namespace truestep::mass_spring
