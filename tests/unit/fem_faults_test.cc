// What a scene may not say about bodies of finite elements, and where it is told so.
#include <algorithm>

#include "engine/base/errors.h"
#include "tests/unit/fem_rig.h"

namespace truestep::fem {
namespace {

using Faults = std::vector<std::string>;

/// Pointers of what the table finds; a fault that shows only in building is the last one.
Faults faults(const FemDef& d) {
  Faults out;
  fem_table().check(&d, [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
  if (!out.empty()) return out;
  try {
    testing_rig::FemRun run(d);
  } catch (const Error& e) {
    for (const Issue& issue : e.issues()) out.push_back(issue.pointer);
  }
  return out;
}

FemDef block() {
  FemDef d;
  d.block = SoftBlockShape{.cells_x = 2, .cells_y = 2, .cells_z = 2};
  return d;
}
FemDef tetrahedron() {
  FemDef d;
  d.mesh = CellsShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 1, 2, 3}};
  d.element = Cell::tet4;
  return d;
}

TEST(FemScene, TakesWhatIsRight) {
  EXPECT_EQ(faults(block()), Faults{});
  EXPECT_EQ(faults(tetrahedron()), Faults{});
}

TEST(FemScene, SaysWhichElementsCannotBe) {
  FemDef d = tetrahedron();
  std::swap(d.mesh->cells[0], d.mesh->cells[1]);
  EXPECT_EQ(faults(d), Faults{"/mesh/cells/0"}) << "inverted";
  d = tetrahedron();
  d.mesh->vertices[3] = {0.3, 0.3, 0};
  EXPECT_EQ(faults(d), Faults{"/mesh/cells/0"}) << "flat";
  d = tetrahedron();
  d.mesh->cells[3] = 2;
  EXPECT_FALSE(faults(d).empty()) << "a corner twice";
  d = tetrahedron();
  d.mesh->cells.push_back(0);
  EXPECT_EQ(faults(d), Faults{"/mesh/cells"}) << "a part of an element";
  d = tetrahedron();
  d.mesh->cells[2] = 4;
  EXPECT_EQ(faults(d), Faults{"/mesh/cells/2"}) << "no such vertex";
  d = tetrahedron();
  d.mesh->vertices.push_back({5, 5, 5});
  EXPECT_EQ(faults(d), Faults{"/mesh/vertices/4"}) << "a vertex without mass";
  d = tetrahedron();
  d.element = Cell::automatic;
  EXPECT_EQ(faults(d), Faults{"/element"});
  d = block();
  d.element = Cell::tri3;
  EXPECT_EQ(faults(d), Faults{"/element"});
  d = block();
  d.block->cells_x = d.block->cells_y = d.block->cells_z = 1000;
  EXPECT_EQ(faults(d), Faults{""}) << "a thousand million elements";
}

TEST(FemScene, SaysWhatContradicts) {
  FemDef d = block();
  d.holds = {{.on = "x0", .x = "0.1"}, {.on = "x0", .x = "0.2"}};
  EXPECT_EQ(faults(d), Faults{"/holds/1"});
  d.holds = {{.on = "x0", .x = "0.1"}};
  d.pinned = {"x0"};
  EXPECT_EQ(faults(d), Faults{"/holds"});
  d = block();
  d.holds = {{.on = "x0", .x = "1/(t-t)"}};
  EXPECT_EQ(faults(d), Faults{"/holds/0"}) << "not finite";
  d.holds = {{.on = "x0", .x = "t +"}};
  EXPECT_EQ(faults(d), Faults{"/holds/0/x"});
  d = block();
  d.pinned = {"left"};
  d.loads = {{.on = "x1", .force = Vec3{1, 0, 0}, .pressure = 3}};
  EXPECT_EQ(faults(d), (Faults{"/pinned/0", "/loads/0"}));
  d = block();
  d.motion = Motion::quasi_static;
  EXPECT_EQ(faults(d), Faults{"/motion"}) << "nothing holds it";
  d = block();
  d.second_share = 0.5;
  EXPECT_EQ(faults(d), Faults{"/second_share"});
}

FemDef ball() {
  FemDef d;
  d.fill = FillShape{.ball = BallRegion{{}, 0.2}, .cylinder = {}, .surface = {}, .spacing = 0.1};
  return d;
}
MeshShape octahedron() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5}};
}

TEST(FemScene, SaysWhatCannotBeFilled) {
  EXPECT_EQ(faults(ball()), Faults{});
  FemDef d = ball();
  d.fill->surface = octahedron();
  EXPECT_EQ(faults(d), Faults{"/fill"}) << "two regions";
  d.fill->ball.reset();
  EXPECT_EQ(faults(d), Faults{});
  d.element = Cell::hex8;
  EXPECT_EQ(faults(d), Faults{"/element"});
  d.element = Cell::tet10;
  EXPECT_EQ(faults(d), Faults{});
  std::swap(d.fill->surface->triangles[0], d.fill->surface->triangles[1]);
  EXPECT_EQ(faults(d).at(0).substr(0, 24), "/fill/surface/triangles/") << "a triangle turned round";
  d = ball();
  d.fill->spacing = 5;
  EXPECT_EQ(faults(d), Faults{"/fill/spacing"}) << "nothing left inside";
  d.fill->spacing = 1e-4;
  EXPECT_EQ(faults(d), Faults{""}) << "far more than two million nodes, refused before they are made";
  d = ball();
  d.pins = {100000};
  EXPECT_EQ(faults(d), Faults{"/pins/0"});
}

TEST(FemScene, SaysWhatABarrierCannotDo) {
  FemDef good = ball();
  good.contact = Meeting::barrier;
  good.copies = {{{0, 0.5, 0}, {0, 0, 1}, {}, 0}, {{0, 1, 0}, {0, 0, 1}, {}, 0}};
  good.colliders.push_back(PlaneColliderDef{});
  EXPECT_EQ(faults(good), Faults{});
  FemDef d = good;
  d.copies[1].position = {0, 0.7, 0};
  EXPECT_EQ(faults(d), Faults{"/contact"}) << "bodies in each other";
  d = good, d.copies[0].position = {0, 0.1, 0};
  EXPECT_EQ(faults(d), Faults{"/contact"}) << "a body in the floor";
  d = good, d.contact_distance = 1;
  EXPECT_EQ(faults(d), Faults{"/contact_distance"}) << "wider than its elements";
  d = good, d.contact_distance = 0;
  EXPECT_EQ(faults(d), Faults{"/contact_distance"});
  d = good, d.integrator = "rk4";
  EXPECT_EQ(faults(d), Faults{"/integrator"});
  d = good, d.restitution = 0.5;
  EXPECT_EQ(faults(d), Faults{"/restitution"});
  d = good, d.loads = {{"border", {}, {}, {}, {}, 10.0}};
  EXPECT_EQ(faults(d), Faults{"/loads/0/pressure"});
  d = good, d.holds = {{"border", "0.1*t", {}, {}}};
  EXPECT_EQ(faults(d), Faults{"/holds/0/x"});
}

}  // namespace
}  // namespace truestep::fem
