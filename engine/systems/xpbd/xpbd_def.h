// Scene parameters of cloth, ropes, hair and soft blocks by position-based dynamics; see xpbd.h.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/collision/points/collider_def.h"
#include "engine/core/def/build.h"
#include "engine/core/def/shape_def.h"
#include "engine/core/outputs.h"

namespace truestep::xpbd {

enum class Scheme : uint8_t { xpbd, pbd };
enum class Sweep : uint8_t { chains, links, jacobi, chebyshev };
enum class Precision : uint8_t { f64, f32 };
/// What resists stretching and shearing in cloth; see kernels/xpbd/membrane.h.
enum class Membrane : uint8_t { links, st_venant_kirchhoff, neo_hookean };

/// Extra mass at a point, such as a hanging weight.
struct LoadDef {
  int64_t point = 0;
  double mass = 1;  // kg
};

/// Turns a rope, a helix or hair into Cosserat rods; see kernels/xpbd/rod_strain.h.
struct RodDef {
  double youngs_modulus = 1e6;          // Pa
  double poisson_ratio = 0.3;           // in G = E / 2 (1 + nu)
  std::optional<double> shear_modulus;  // Pa, instead
  std::optional<double> width, height;  // m, along d1 and d2 of a rectangle; absent: round, of this thickness
  std::optional<double> torsion_constant;  // m^4
  enum class Natural : uint8_t { as_shaped, straight } natural = Natural::as_shaped;
  double twist = 0;         // rad, from the first to the last section at the start
  double twist_rate = 0;    // rad/s, of the clamped last section about the rod's axis
  double damping_time = 0;  // s, internal: moments and forces per strain rate over those per strain
  Vec3 up{0, 1, 0};         // direction closest to d2 of the first section
  std::vector<std::string> clamped;
};

/// Limits beyond which links between neighbours of a cloth tear; see tear_surface.h.
struct TearDef {
  std::optional<double> strain, force;  // 1, N
  std::optional<int64_t> most_splits;   // default: the number of points
};

/// A point held to a position by a spring.
struct AttachmentDef {
  int64_t point = 0;
  std::optional<Vec3> target{};       // m; absent: where the point starts
  std::optional<double> stiffness{};  // N/m; absent: that of a drag command
};

/// One more copy of a shape: turned about the origin, then moved.
struct CopyDef {
  Vec3 position, axis{0, 0, 1}, velocity;  // m, -, m/s
  double angle = 0;                        // rad
};

/// Shape matching; see kernels/xpbd/shape_match.h.
struct MatchDef {
  std::optional<double> frequency;  // Hz; absent: rigid
  double linear = 0;
};

/// Whether all links are solved at once from the same positions.
inline bool is_simultaneous(Sweep s) {
  return s >= Sweep::jacobi;
}

struct XpbdDef {
  std::optional<RopeShape> rope;
  std::optional<HelixShape> helix;
  std::optional<HairShape> hair;
  std::optional<ClothGridShape> cloth_grid;
  std::optional<MeshShape> mesh;
  std::optional<SoftBlockShape> block;
  std::vector<CopyDef> copies;  // for mesh and block

  double mass = 0.01;             // kg per point
  std::optional<double> density;  // kg/m, kg/m^2 or kg/m^3, instead of mass
  std::vector<LoadDef> loads;
  double stiffness = 10000;  // N/m
  double shear_stiffness = 1000;
  std::optional<double> youngs_modulus;  // Pa, instead of both
  std::optional<double> poisson_ratio;   // for an elastic block or a membrane
  Membrane membrane = Membrane::links;
  double bulk_modulus = 1e5;     // Pa, for a block
  double bending_rigidity = 0;   // N m^2, EI of a rope or hair
  double flexural_rigidity = 0;  // N m, D of cloth
  double rest_scale = 1;
  double damping = 0;           // N s/m per point
  double internal_damping = 0;  // N s/m per link
  Vec3 velocity;                // m/s, initial
  std::vector<int64_t> pins;
  std::vector<std::string> pinned;
  std::optional<RodDef> rod;
  std::optional<TearDef> tear;
  std::vector<AttachmentDef> attachments;
  std::optional<double> tether_slack;  // 1, for long-range attachments; absent: none
  std::optional<MatchDef> matching;
  std::optional<Vec3> wind;  // m/s
  double gust = 0, gust_period = 2;
  double air_density = 1.2, drag_coefficient = 1.2;
  double thickness = 0.01;  // m
  std::optional<Vec3> color;
  double restitution = 0;
  std::optional<double> friction;
  bool self_collision = false;
  double self_friction = 0.3;
  ColliderDefs colliders;

  Scheme scheme = Scheme::xpbd;
  Sweep sweep = Sweep::chains;
  Precision precision = Precision::f64;
  std::optional<int> substeps, iterations;
  double projection = 1;  // share of a correction that PBD applies
};

const DefTable& xpbd_table();
const DefTable& rod_table();
/// Checks a rod against the rest of the scene.
void check_rod(const XpbdDef& def, const DefTable::Report& report);
const DefTable& copy_table();
const DefTable& match_table();
/// Checks copies, matching and the material of a block against each other.
void check_soft(const XpbdDef& def, const DefTable::Report& report);
const DefTable& attachment_table();
/// Checks membranes, attachments and tethers against the rest of the scene.
void check_sheet(const XpbdDef& def, const DefTable::Report& report);
inline bool is_membrane(const XpbdDef& def) {
  return def.membrane != Membrane::links && (def.cloth_grid || def.mesh);
}
const DefTable& tear_table();
void check_tear(const XpbdDef& def, const DefTable::Report& report);
/// Names of the ends that this shape's rods have.
std::vector<std::string> clamp_names(const XpbdDef& def);
const Outputs& xpbd_outputs();
Cost xpbd_cost(const void* def);
/// s on one core.
double substep_seconds(const XpbdDef& def);
/// Numbers of points and of constraints of every kind, from counts alone (an upper bound for meshes).
struct XpbdCounts {
  double points = 0, links = 0, bends = 0, volumes = 0;
};
XpbdCounts xpbd_counts(const XpbdDef& def);

}  // namespace truestep::xpbd
