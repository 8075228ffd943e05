// Points and springs of a shape, as its builder produces them, before they become a force field.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/drawing.h"
#include "engine/systems/mass_spring/mass_spring_def.h"

namespace truestep::mass_spring {

inline constexpr size_t kSpringFamilies = 4;
/// `own`: the spring's stiffness is its own, in N/m.
enum class SpringFamily : uint8_t { structural, shear, bending, own };
LineKind line_kind(SpringFamily family);

struct SpringLink {
  uint32_t a, b;
  SpringFamily family;
  double rest;   ///< m
  double scale;  ///< stiffness as a multiple of the family's (own: N/m)
};

/// Two links that meet in the second point and resist bending (kernels/springs/bending.h).
struct Bend {
  std::array<uint32_t, 3> points;
  double stiffness;  ///< J
};

struct Network {
  std::vector<Vec3> x, v;     ///< m, m/s
  std::vector<double> share;  ///< length (m) or area (m^2) of a point; free networks: its mass if given
  std::vector<SpringLink> springs;
  std::vector<Bend> bends;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint32_t> pins;  ///< ascending, each once
};

/// Positions, springs with rest lengths, triangles, pins. `down` is the direction in which a slack rope sags.
Network build_network(const MassSpringDef& def, const Vec3& down);
/// Masses in kg from the def's mass, density or list.
std::vector<double> point_masses(const MassSpringDef& def, const Network& network);

// The builders of the shapes: positions, shares and links with family (rest lengths are filled in later where
// they are negative).
void build_rope(const RopeShape& shape, const MassSpringDef& def, const Vec3& down, Network& out);
void build_hair(const HairShape& shape, const MassSpringDef& def, Network& out);
void build_cloth_grid(const ClothGridShape& shape, const MassSpringDef& def, Network& out);
void build_mesh(const MeshShape& shape, const MassSpringDef& def, Network& out);
void build_free(const FreeShape& shape, Network& out);

}  // namespace truestep::mass_spring
