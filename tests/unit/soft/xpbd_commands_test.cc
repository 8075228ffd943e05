// Commands to cloth and ropes, energies, and what a scene must not contain.
#include "engine/base/errors.h"
#include "tests/unit/soft/xpbd_rig.h"

namespace truestep {
using namespace xpbd;
namespace {

using testing_rig::XpbdRun;

XpbdDef rope(int links) {
  XpbdDef d;
  d.rope = RopeShape{.to = {1, 0, 0}, .links = links};
  return d;
}

std::vector<std::string> faults(const XpbdDef& d) {
  std::vector<std::string> out;
  xpbd_table().check(&d, [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
  return out;
}

TEST(XpbdCommands, HandsPushDragAndPin) {
  XpbdRun run(rope(10), 1.0 / 60, {});
  run.system->apply(run.state, {.kind = CommandKind::pin, .index = 0});
  run.system->apply(run.state,
                    {.kind = CommandKind::drag, .index = 10, .vector = {0.6, 0.6, 0}, .value = 1000});
  run.seconds(3);
  EXPECT_EQ(run.position(0), (Vec3{0, 0, 0}));
  EXPECT_LT(norm(run.position(10) - Vec3{0.6, 0.6, 0}), 1e-3);
  run.system->apply(run.state, {.kind = CommandKind::release});
  run.system->apply(run.state, {.kind = CommandKind::unpin, .index = 0});
  const double before = run.observe("momentum.y");
  run.system->apply(run.state, {.kind = CommandKind::push, .index = 5, .vector = {0, 3, 0}, .duration = 0.5});
  run.seconds(1);
  // Force times time, whatever the rope does: constraints conserve momentum.
  EXPECT_NEAR(run.observe("momentum.y") - before, 1.5, 1e-12);
  run.system->apply(run.state, {.kind = CommandKind::impulse, .index = 3, .vector = {0, 0, 2}});
  run.seconds(0.5);
  EXPECT_NEAR(run.observe("momentum.z"), 2, 1e-12);
}

TEST(XpbdCommands, ParametersChangeWhatIsThere) {
  XpbdRun run(rope(4));
  run.system->apply(run.state, {.kind = CommandKind::set_parameter, .value = 5, .name = "stiffness"});
  EXPECT_EQ(run.state.f64(XpbdColumns::stiffness)[0], 5);
  for (const char* name :
       {"youngs_modulus", "flexural_rigidity", "bulk_modulus", "shear_stiffness", "colour"}) {
    EXPECT_THROW(run.system->apply(run.state, {.kind = CommandKind::set_parameter, .name = name}), Error)
        << name;
  }
  EXPECT_THROW(run.system->apply(run.state, {.kind = CommandKind::spawn}), Error);
  EXPECT_THROW(run.system->apply(run.state, {.kind = CommandKind::pin, .index = 5}), Error);
}

TEST(XpbdScene, SaysWhatItCannotTake) {
  EXPECT_TRUE(faults(rope(4)).empty());
  EXPECT_EQ(faults({}).size(), 1u);
  XpbdDef d = rope(4);
  d.flexural_rigidity = 1, d.projection = 0.5, d.pins = {9}, d.loads = {{7, 1}}, d.pinned = {"corners"};
  EXPECT_EQ(faults(d), (std::vector<std::string>{"/flexural_rigidity", "/projection", "/pins/0",
                                                 "/loads/0/point", "/pinned/0"}));
  XpbdDef block;
  block.block = SoftBlockShape{};
  block.youngs_modulus = 1e5;
  EXPECT_TRUE(faults(block).empty());
  block.precision = Precision::f32, block.internal_damping = 1, block.matching.emplace();
  EXPECT_EQ(faults(block), (std::vector<std::string>{"/youngs_modulus", "/internal_damping", "/precision"}));
  XpbdDef sheet;
  sheet.mesh.emplace(), sheet.youngs_modulus = 1e5, sheet.poisson_ratio = 0.3;
  EXPECT_EQ(faults(sheet), (std::vector<std::string>{"/youngs_modulus", "/poisson_ratio"}));
}

TEST(XpbdScene, SelfCollisionNeedsAThicknessThatFits) {
  XpbdDef d;
  d.cloth_grid = ClothGridShape{.nx = 11, .ny = 11};
  d.self_collision = true, d.thickness = 0.1;
  EXPECT_TRUE(faults(d).empty());
  d.thickness = 0.11;
  EXPECT_EQ(faults(d), std::vector<std::string>{"/thickness"});
  d.thickness = 0;
  EXPECT_EQ(faults(d), std::vector<std::string>{"/self_collision"});
  d.self_collision = false, d.thickness = 0.11;
  EXPECT_TRUE(faults(d).empty());
}

TEST(XpbdCommands, WindIsSetWhereThereIsAir) {
  const Command wind{.kind = CommandKind::set_parameter, .vector = {0, 0, 3}, .name = "wind"};
  XpbdRun none(rope(4));
  EXPECT_THROW(none.system->apply(none.state, wind), Error);
  XpbdDef d = rope(4);
  d.wind = Vec3{};
  XpbdRun run(d, 1.0 / 60, {});
  run.step();
  EXPECT_EQ(run.observe("momentum.z"), 0);
  run.system->apply(run.state, wind);
  run.step();
  EXPECT_GT(run.observe("momentum.z"), 0);
}

TEST(XpbdEnergy, PotentialIsThatOfItsConstraints) {
  // One link pulled apart, one triangle pair bent, one cell squeezed: energies by hand.
  XpbdRun link(rope(1), 1.0 / 60, {});
  link.state.f64(XpbdColumns::position)[3] = 1.1;
  EXPECT_NEAR(link.observe("energy.potential"), 0.5 * 10000 * 0.01, 1e-9);

  XpbdDef bent = rope(2);
  bent.bending_rigidity = 2;
  XpbdRun rod(bent, 1.0 / 60, {});
  rod.state.f64(XpbdColumns::position)[4] = 1e-4;
  // Curvature 8e-4 1/m over 1/2 m: 1/2 EI k^2 l; the links' own (4e-8)^2 is negligible.
  EXPECT_NEAR(rod.observe("energy.potential"), 0.5 * 2 * 0.64e-6 * 0.5, 1e-12);

  XpbdDef cell;
  cell.block = SoftBlockShape{.cells_x = 1, .cells_y = 1, .cells_z = 1};
  cell.stiffness = 1e-9, cell.bulk_modulus = 30;
  XpbdRun cube(cell, 1.0 / 60, {});
  for (size_t i = 0; i < 8; ++i) cube.state.f64(XpbdColumns::position)[3 * i] *= 1.1;
  EXPECT_NEAR(cube.observe("energy.potential"), 0.5 * 30 * 0.01, 1e-6);
}

}  // namespace
}  // namespace truestep
