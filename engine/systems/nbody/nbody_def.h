// What a scene says about bodies that attract each other; units and bounds are in the table (nbody_def.cc).
#pragma once
#include <optional>
#include <variant>
#include <vector>

#include "engine/core/equations/integrator_def.h"
#include "engine/core/outputs.h"
#include "engine/kernels/gravity/softening.h"

namespace truestep::nbody {

/// Members of all groups of bodies.
struct Placed {
  Vec3 center, velocity;  // m, m/s
};

/// Plummer sphere in equilibrium (Aarseth, Henon & Wielen 1974).
struct PlummerDef : Placed {
  int64_t count = 1000;
  double mass = 1, radius = 1;  // kg in all, m (the model's a)
  double cut = 20;              // radii beyond which no body is placed
};

/// A ball of uniform density.
struct SphereDef : Placed {
  int64_t count = 1000;
  double mass = 1, radius = 1;
  double virial_ratio = 0;  // 2 K / |W|, 0: at rest
};

/// A disk galaxy: an exponential disk, a central body and a surrounding Plummer sphere.
struct GalaxyDef : Placed {
  int64_t count = 2000;
  double mass = 1, scale_length = 1, height = 0.1;
  double dispersion = 0.05;  // random speeds relative to the circular one
  double central_mass = 0;
  int64_t halo_count = 0;
  double halo_mass = 0, halo_radius = 2;
  Vec3 axis{0, 0, 1};
};

/// Bodies on circular orbits around one of the bodies of the scene.
struct RingDef {
  int64_t count = 1000, around = 0;
  double mass = 0, inner_radius = 1, outer_radius = 2;  // kg in all
  double thickness = 0, body_radius = 0;
  Vec3 axis{0, 0, 1};
};

/// A body on a Kepler orbit around one of the bodies of the scene.
struct OrbitDef {
  int64_t around = 0;
  double mass = 0, radius = 0;
  double semi_major_axis = 1, eccentricity = 0;
  double inclination = 0, ascending_node = 0, periapsis = 0, mean_anomaly = 0;  // rad
};

using GroupDef = std::variant<PlummerDef, SphereDef, GalaxyDef, RingDef, OrbitDef>;

enum class Method : uint8_t { automatic, direct, mixed, tree, fmm };
enum class Response : uint8_t { merge, bounce, stop };

struct CollisionsDef {
  Response response = Response::merge;
  double restitution = 0.5;
};

struct NbodyDef : IntegratorParams {
  double gravitational_constant = 6.67430e-11;
  std::vector<Vec3> positions, velocities;
  std::vector<double> masses, radii;
  double mass = 1, radius = 0;
  std::vector<GroupDef> groups;
  gravity::SofteningKind softening_kind = gravity::SofteningKind::plummer;
  double softening = 0;
  Method method = Method::automatic;
  double force_error = 1e-3;
  std::optional<CollisionsDef> collisions;
  std::optional<double> draw_radius;
  std::optional<Vec3> color;
};

inline constexpr int64_t kMostBodies = 4'000'000;
/// Few bodies are planets or the like: their positions matter, and close passages need short steps.
inline constexpr size_t kFewBodies = 32;

const DefTable& nbody_table();
const Outputs& nbody_outputs();
Cost nbody_cost(const void* def);
/// Number of bodies at t = 0.
size_t body_count(const NbodyDef& def);
/// How n bodies are summed: as requested, or the fastest way; never automatic.
Method chosen_method(const NbodyDef& def, size_t n);

}  // namespace truestep::nbody
