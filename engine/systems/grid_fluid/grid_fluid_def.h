// The definition of a fluid's flow through a box in a scene; see grid_fluid.h.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/collision/points/kill_def.h"
#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/def/resolution.h"
#include "engine/core/def/source_def.h"
#include "engine/core/outputs.h"
#include "engine/kernels/mac/mac_grid.h"
#include "engine/lattice/box_sides.h"
#include "engine/math/quaternion.h"

namespace truestep::grid_fluid {

/// The condition on a side of the box: the fluid sticks to a wall (which may move along itself), slides along
/// it, flows in with a given velocity, flows out against zero pressure, or re-enters at the other end.
enum class SideKind : uint8_t { wall, slip, inflow, outflow, periodic };

struct FlowSideDef {
  SideKind kind = SideKind::wall;
  std::vector<std::string> velocity;  ///< m/s; empty: 0
  std::optional<double> dye = {};     ///< of the liquid that flows in
};
using FlowSidesDef = lattice::BoxSides<FlowSideDef>;

/// A scalar that the flow carries: smoke, dye, salt.
struct ScalarDef {
  std::string initial = "0", source = "0";
  double diffusivity = 0;  ///< m^2/s
  double expansion = 0;    ///< acceleration = -gravity expansion scalar: positive values rise
};

/// A second fluid in the same box that does not mix with the first.
struct SecondFluidDef {
  std::string where = "0";          ///< positive where it is at the start
  double density = 1;               ///< kg/m^3, or kg/m^2 in the plane
  std::optional<double> viscosity;  ///< kinematic, m^2/s; empty: that of the first
};

/// A solid in the flow, at rest or moved by the scene.
struct ObstacleDef {
  enum class Shape : uint8_t { sphere, box } shape = Shape::sphere;
  Vec3 center;
  double radius = 0.1;                    ///< m
  Vec3 half{0.1, 0.1, 0.1};               ///< m
  std::vector<std::string> displacement;  ///< m, of the centre; empty: at rest
  std::string angle;                      ///< rad, about `axis`; empty: does not rotate
  Vec3 axis{0, 0, 1};
  Quat turned;  ///< orientation of an obstacle that has been placed
};

/// Liquid at the start.
struct LiquidBodyDef {
  ObstacleDef::Shape shape = ObstacleDef::Shape::box;
  Vec3 center;
  double radius = 0.1;       ///< m
  Vec3 half{0.1, 0.1, 0.1};  ///< m
  Vec3 velocity;             ///< m/s, added to `initial`
  std::optional<double> dye = {};
};

/// A nozzle that pours liquid.
struct LiquidInletDef : SourceDef {
  std::optional<double> dye = {};
};

struct GridFluidDef : KillDefs {
  std::vector<int64_t> cells = {64, 64};
  std::vector<double> size;    ///< m; empty: 1 along every axis
  std::optional<Vec3> origin;  ///< m, lower corner
  std::optional<FlowSideDef> all;
  FlowSidesDef sides;
  double viscosity = 0;  ///< kinematic, m^2/s
  double density = 1;    ///< kg/m^3, or kg/m^2 in the plane
  enum class Advection : uint8_t {
    central,
    semi_lagrangian,
    maccormack,
    bfecc,
    flip,
    apic
  } advection = Advection::central;
  enum class Order : uint8_t { second, fourth } order = Order::second;
  enum class Stepping : uint8_t { rk3, ab2, steady } stepping = Stepping::rk3;
  enum class Viscous : uint8_t { automatic, explicit_, implicit } viscous = Viscous::automatic;
  std::optional<double> cfl;
  std::vector<std::string> initial, force, exact;
  std::optional<ScalarDef> scalar;
  std::optional<SecondFluidDef> second_fluid;
  double vorticity_confinement = 0;
  std::vector<ObstacleDef> obstacles;
  double tolerance = 1e-6;  ///< of the pressure with obstacles; of a steady flow's last change
  std::vector<LiquidBodyDef> bodies;
  std::vector<LiquidInletDef> emitters;
  std::optional<int64_t> max_particles;
  int particles_per_axis = 2;
  double flip = 0.97;

  /// Whether the flow is steady, found directly instead of stepped.
  bool steady() const { return stepping == Stepping::steady; }
  /// Whether it is a liquid with a surface, carried by particles.
  bool liquid() const { return advection == Advection::flip || advection == Advection::apic; }
};

const DefTable& grid_fluid_table();
const Outputs& grid_fluid_outputs();
Cost grid_fluid_cost(const void* def);
const Resolution& grid_fluid_resolution();

/// The grid of the scene.
mac::MacGrid make_grid(const GridFluidDef& d);
/// m, initial positions of a liquid's particles: centres of the grid's cells divided by particles_per_axis
/// that lie in a body and in no obstacle (in its initial pose); with the number of the body.
struct StartingPlace {
  Vec3 at;
  size_t body;
};
std::vector<StartingPlace> starting_places(const GridFluidDef& d, std::span<const ObstacleDef> obstacles);
/// Their number, estimated from the volumes of the bodies.
double expected_particles(const GridFluidDef& d);
/// Most particles of a liquid at once, given `start` of them at the start.
size_t largest_count(const GridFluidDef& d, size_t start);
/// Whether liquid flows through a side.
bool lets_through(SideKind kind);
/// Whether the number of a liquid's particles can change.
bool changes(const GridFluidDef& d);
/// Whether a liquid's particles carry a dye.
bool dyed(const GridFluidDef& d);
const FlowSideDef& side_of(const GridFluidDef& d, size_t axis, size_t end);
/// "/sides/x_min", or "/side" if that member decides.
std::string side_pointer(const GridFluidDef& d, size_t axis, size_t end);

}  // namespace truestep::grid_fluid
