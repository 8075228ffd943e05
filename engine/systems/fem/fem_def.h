// Scene parameters of elastic bodies of finite elements; see fem.h.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/collision/points/collider_def.h"
#include "engine/core/def/resolution.h"
#include "engine/core/def/shape_def.h"
#include "engine/core/equations/integrator_def.h"
#include "engine/core/outputs.h"
#include "engine/geometry/make/stuffing.h"
#include "engine/kernels/fem/element.h"
#include "engine/kernels/fem/material.h"

namespace truestep::fem {

/// Strain and stress: bodies in the plane z = 0. Membrane and shell: sheets in space.
enum class Plane : uint8_t { strain, stress, membrane, shell };
enum class Volume : uint8_t { automatic, pointwise, mean };
enum class Incompatible : uint8_t { none, wilson };
enum class Motion : uint8_t { dynamic, quasi_static };
enum class Meeting : uint8_t { nodes, barrier };
/// As scenes name them: automatic, then the first eight of ElementKind in the same order.
enum class Cell : uint8_t { automatic, tri3, tri6, quad4, quad9, tet4, tet10, hex8, hex27 };
ElementKind kind_of(Cell cell);

struct QuadShape {
  std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};  // m, anticlockwise
  int cells_x = 4, cells_y = 4;
};

struct BallRegion {
  Vec3 center;
  double radius = 0.5;  // m
};

struct CylinderRegion {
  Vec3 from, to{0, 1, 0};
  double radius = 0.5;  // m
};

/// A region filled with tetrahedra: one of the three.
struct FillShape {
  std::optional<BallRegion> ball;
  std::optional<CylinderRegion> cylinder;
  std::optional<MeshShape> surface;
  double spacing = 0.1;  // m
};

/// A named set of points.
struct SetDef {
  std::string name;
  std::vector<int64_t> points;
  std::optional<Vec3> low, high;  // m
};

/// The kind of cells in a mesh.
enum class Form : uint8_t { as_element, triangles, quadrangles, tetrahedra, hexahedra };

struct CellsShape {
  std::vector<Vec3> vertices;  // m
  std::vector<int64_t> cells;  // corners of every element, one after another
  Form form = Form::as_element;
  std::vector<SetDef> sets;
};

/// Prescribed displacement components of a set; expressions of t, X, Y, Z.
struct HoldDef {
  std::string on;
  std::optional<std::string> x, y, z;  // m
};

/// Loads on a set's part of the surface; the traction's components are expressions of X, Y, Z.
struct LoadDef {
  std::string on;
  std::optional<Vec3> force;           // N, total
  std::optional<std::string> x, y, z;  // Pa
  std::optional<double> pressure;      // Pa
};

/// One more copy: the shape turned about the origin, then moved.
struct CopyDef {
  Vec3 position, axis{0, 0, 1}, velocity;  // m, -, m/s
  double angle = 0;                        // rad
};

struct FemDef : IntegratorParams {
  std::optional<SoftBlockShape> block;
  std::optional<QuadShape> quad;
  std::optional<CellsShape> mesh;
  std::optional<FillShape> fill;
  std::vector<CopyDef> copies;
  Cell element = Cell::automatic;
  Plane plane = Plane::strain;
  double plane_thickness = 1;  // m
  std::vector<SetDef> sets;

  Law material = Law::neo_hookean;
  double youngs_modulus = 1e5, poisson_ratio = 0.3, density = 1000;
  double second_share = 0;
  Volume volume = Volume::automatic;
  Incompatible incompatible_modes = Incompatible::none;
  double damping = 0;  // 1/s

  Vec3 velocity;
  std::vector<int64_t> pins;
  std::vector<std::string> pinned, clamped;
  std::vector<HoldDef> holds;
  std::vector<LoadDef> loads;
  double load_time = 0;  // s

  Motion motion = Motion::dynamic;
  int modes = 0;

  Meeting contact = Meeting::nodes;
  std::optional<double> contact_distance;  // m
  double restitution = 0;
  std::optional<double> friction;
  ColliderDefs colliders;
};

const DefTable& fem_table();
const Outputs& fem_outputs();
Cost fem_cost(const void* def);
const Resolution& fem_resolution();
/// Reports all that is wrong with a def.
void check_fem(const FemDef& def, const DefTable::Report& report);
/// In the order of Cell.
const std::vector<std::string>& cell_names();
/// Never automatic.
Cell cell_of(const FemDef& def);
bool in_plane(const FemDef& def);
/// Whether elements are triangles or quadrangles in space.
bool is_sheet(const FemDef& def);
/// The region that a def fills; null: none.
std::unique_ptr<Region> region_of(const FemDef& def);
/// Names of the def's sets, except those that no shape provides.
std::vector<std::string> set_names(const FemDef& def);
/// Numbers of nodes, elements and blocks of the stiffness matrix, from counts alone.
struct FemCounts {
  double nodes = 0, elements = 0, blocks = 0;
};
FemCounts fem_counts(const FemDef& def);

}  // namespace truestep::fem
