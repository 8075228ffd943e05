// Meshes that cannot be cloth: edges without length, triangles without area, edges of three triangles.
// mass_spring used to accept the first two and turned them into points without mass.
#include <gtest/gtest.h>

#include "engine/systems/mass_spring/mass_spring.h"
#include "engine/systems/xpbd/xpbd.h"

namespace truestep {
namespace {

using Pointers = std::vector<std::string>;

Pointers of_springs(const mass_spring::MassSpringDef& d) {
  Pointers out;
  mass_spring::mass_spring_table().check(&d,
                                         [&](const std::string& p, const std::string&) { out.push_back(p); });
  return out;
}
Pointers of_constraints(const xpbd::XpbdDef& d) {
  Pointers out;
  xpbd::xpbd_table().check(&d, [&](const std::string& p, const std::string&) { out.push_back(p); });
  return out;
}

const MeshShape kSquare{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3}};
/// Three triangles on the edge of vertices 0 and 1.
const MeshShape kBook{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {0, 1, 2, 1, 0, 3, 0, 1, 4}};

TEST(ClothMeshFaults, FlatTrianglesAreNamed) {
  MeshShape no_length = kSquare, no_area = kSquare;
  no_length.vertices[3] = no_length.vertices[2];
  no_area.vertices[3] = {0.5, 0.5, 0};
  mass_spring::MassSpringDef springs;
  xpbd::XpbdDef constraints;
  springs.mesh = constraints.mesh = kSquare;
  EXPECT_EQ(of_springs(springs), Pointers{});
  EXPECT_EQ(of_constraints(constraints), Pointers{});
  springs.mesh = constraints.mesh = no_length;
  EXPECT_EQ(of_springs(springs), Pointers{"/mesh/triangles/4"});
  EXPECT_EQ(of_constraints(constraints), Pointers{"/mesh/triangles/4"});
  springs.mesh = constraints.mesh = no_area;
  EXPECT_EQ(of_springs(springs), Pointers{"/mesh/triangles/3"});
  EXPECT_EQ(of_constraints(constraints), Pointers{"/mesh/triangles/3"});
}

TEST(ClothMeshFaults, WhatBendsAtAnEdgeOfThreeTrianglesIsNotKnown) {
  mass_spring::MassSpringDef springs;
  xpbd::XpbdDef constraints;
  springs.mesh = constraints.mesh = kBook;
  springs.bending_stiffness = 1;
  constraints.flexural_rigidity = 1e-3;
  EXPECT_EQ(of_springs(springs), Pointers{"/mesh/triangles/6"});
  EXPECT_EQ(of_constraints(constraints), Pointers{"/mesh/triangles/6"});
  // Without bending stiffness it is cloth joined along an edge, which the plan mentions.
  springs.bending_stiffness = 0;
  constraints.flexural_rigidity = 0;
  EXPECT_EQ(of_springs(springs), Pointers{});
  EXPECT_EQ(of_constraints(constraints), Pointers{});
  const auto said = [](const System& system) {
    for (const PlanRow& row : system.plan()) {
      if (row.name == "bending at crowded edges")
        return row.reason.find("vertices 0 and 1") != std::string::npos;
    }
    return false;
  };
  const BuildContext context{.id = "c", .dt = 1.0 / 60};
  EXPECT_TRUE(said(*mass_spring::build_mass_spring(&springs, context)));
  EXPECT_TRUE(said(*xpbd::build_xpbd(&constraints, context)));
  springs.mesh = constraints.mesh = kSquare;
  EXPECT_FALSE(said(*mass_spring::build_mass_spring(&springs, context)));
  EXPECT_FALSE(said(*xpbd::build_xpbd(&constraints, context)));
}

}  // namespace
}  // namespace truestep
