// What a scene must not contain about finite element bodies, and where the error is reported.
#include <algorithm>

#include "engine/base/errors.h"
#include "tests/unit/fem/fem_rig.h"

namespace truestep::fem {
namespace {

using Faults = std::vector<std::string>;

/// Pointers of the errors that the table finds; an error that shows only on building comes last.
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

FemDef faulty_block() {
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
  EXPECT_EQ(faults(faulty_block()), Faults{});
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
  d = faulty_block();
  d.element = Cell::tri3;
  EXPECT_EQ(faults(d), Faults{"/element"});
  d = faulty_block();
  d.block->cells_x = d.block->cells_y = d.block->cells_z = 1000;
  EXPECT_EQ(faults(d), Faults{""}) << "a thousand million elements";
}

TEST(FemScene, SaysWhatContradicts) {
  FemDef d = faulty_block();
  d.holds = {{.on = "x0", .x = "0.1"}, {.on = "x0", .x = "0.2"}};
  EXPECT_EQ(faults(d), Faults{"/holds/1"});
  d.holds = {{.on = "x0", .x = "0.1"}};
  d.pinned = {"x0"};
  EXPECT_EQ(faults(d), Faults{"/holds"});
  d = faulty_block();
  d.holds = {{.on = "x0", .x = "1/(t-t)"}};
  EXPECT_EQ(faults(d), Faults{"/holds/0"}) << "not finite";
  d.holds = {{.on = "x0", .x = "t +"}};
  EXPECT_EQ(faults(d), Faults{"/holds/0/x"});
  d = faulty_block();
  d.pinned = {"left"};
  d.loads = {{.on = "x1", .force = Vec3{1, 0, 0}, .pressure = 3}};
  EXPECT_EQ(faults(d), (Faults{"/pinned/0", "/loads/0"}));
  d = faulty_block();
  d.motion = Motion::quasi_static;
  EXPECT_EQ(faults(d), Faults{"/motion"}) << "nothing holds it";
  d = faulty_block();
  d.second_share = 0.5;
  EXPECT_EQ(faults(d), Faults{"/second_share"});
}

TEST(FemScene, SaysWhatAMeshOfAFileCannotBe) {
  FemDef d = tetrahedron();
  d.element = Cell::automatic, d.mesh->form = Form::tetrahedra;
  EXPECT_EQ(faults(d), Faults{}) << "of first order where no element is named";
  EXPECT_EQ(cell_of(d), Cell::tet4);
  d.element = Cell::tet10;
  EXPECT_EQ(faults(d), Faults{});
  d.element = Cell::hex8;
  EXPECT_EQ(faults(d), (Faults{"/element", "/mesh/cells"}));
  d = tetrahedron();
  d.mesh->sets = {{"foot", {0, 4}, {}, {}}};
  EXPECT_EQ(faults(d), Faults{"/mesh/sets/0/points/1"}) << "there are four vertices";
  d.mesh->sets = {{"foot", {0, 1}, {}, {}}};
  d.pinned = {"foot"};
  EXPECT_EQ(faults(d), Faults{});
  d.sets = {{"foot", {2}, {}, {}}};
  EXPECT_EQ(faults(d), Faults{"/sets/0/name"});
  d = tetrahedron();
  d.mesh->sets = {{"all", {0}, {}, {}}};
  EXPECT_EQ(faults(d), Faults{"/mesh/sets"}) << "every body has a set of that name";
  // Three tetrahedra on one face.
  d = tetrahedron();
  d.mesh->vertices.insert(d.mesh->vertices.end(), {{0, 0, -1}, {0.1, 0.1, 2}});
  d.mesh->cells.insert(d.mesh->cells.end(), {0, 2, 1, 4, 0, 1, 2, 5});
  EXPECT_EQ(faults(d), Faults{"/mesh/cells/8"});
}

FemDef sheet() {
  FemDef d;
  d.quad = QuadShape{.cells_x = 2, .cells_y = 2};
  d.element = Cell::tri6, d.plane = Plane::shell, d.plane_thickness = 0.01;
  return d;
}

TEST(FemScene, SaysWhatASheetCannotBe) {
  EXPECT_EQ(faults(sheet()), Faults{});
  FemDef d = sheet();
  d.element = Cell::quad9;
  EXPECT_EQ(faults(d), Faults{"/element"}) << "shells are of tri6";
  d.plane = Plane::membrane;
  EXPECT_EQ(faults(d), Faults{});
  d.clamped = {"x0"};
  EXPECT_EQ(faults(d), Faults{"/clamped"});
  d = sheet();
  d.clamped = {"left"};
  EXPECT_EQ(faults(d), Faults{"/clamped/0"});
  d = sheet();
  d.material = Law::linear;
  EXPECT_EQ(faults(d), Faults{"/material"});
  d = sheet();
  d.contact = Meeting::barrier;
  EXPECT_EQ(faults(d), Faults{"/contact"});
  d = faulty_block();
  d.plane = Plane::shell;
  EXPECT_EQ(faults(d), Faults{"/plane"});
  d = sheet();
  d.loads = {{.on = "x1", .pressure = 3}};
  EXPECT_EQ(faults(d), Faults{"/loads/0/pressure"}) << "an edge has no area";
  d.loads = {{.on = "x1", .force = Vec3{0, 0, 1}}, {.on = "all", .pressure = 3}};
  EXPECT_EQ(faults(d), Faults{});
  // A triangle without area, in space, and three triangles on an edge.
  d = sheet();
  d.quad.reset();
  d.mesh = CellsShape{{{0, 0, 0}, {1, 0, 1}, {0, 1, 0}, {2, 0, 2}}, {0, 1, 2, 0, 1, 3}};
  EXPECT_EQ(faults(d), Faults{"/mesh/cells/3"});
  d.mesh = CellsShape{{{0, 0, 0}, {1, 0, 1}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {0, 1, 2, 1, 0, 3, 0, 1, 4}};
  EXPECT_EQ(faults(d), Faults{"/mesh/cells/6"});
  // Both triangles on the same side of their edge: a shell has no normal there, and used to stay motionless.
  d.mesh = CellsShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.7, 0}}, {0, 1, 2, 1, 0, 3}};
  EXPECT_EQ(faults(d), Faults{"/mesh/cells/3"});
  d.mesh->vertices[3].z = 0.5;
  EXPECT_EQ(faults(d), Faults{});
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
