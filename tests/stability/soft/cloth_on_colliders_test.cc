// Stiff cloth that falls on rigid solids: points held to a surface are part of the step's own solve, so that
// no spring is stretched by moving them there.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/session/session.h"

namespace truestep {
namespace {

struct Fall {
  double gain = 0, deepest = 0;  ///< J above the start's energy, m below the surface
  int steps = 0;                 ///< of 60
};

Fall fall(double stiffness, const std::string& more = "") {
  const std::string k = std::to_string(stiffness);
  const auto arena = std::make_shared<const ThreadArena>(1);
  Session s(std::make_shared<const World>(parse_scene(
                R"({"schema_version": "1.0", "time": {"dt": 0.016666666666666666, "duration": 1}, "systems": [
      {"type": "mass_spring", "id": "c", "cloth_grid": {"origin": [-0.5, 1, -0.5], "edge_u": [1, 0, 0],
       "edge_v": [0, 0, 1], "nx": 7, "ny": 7}, "mass": 0.02, "thickness": 0.02, "stiffness": )" +
                k + R"(, "shear_stiffness": )" + k + R"(, "colliders": [
       {"type": "sphere", "center": [0, 0.6, 0], "radius": 0.3, "restitution": 0.5, "friction": 0.3},
       {"type": "plane", "point": [0, 0, 0], "friction": 0.5}])" +
                more + "}]}")),
            arena, {.history_bytes = 0});
  const double start = s.observe().find("energy.total").value();
  Fall out;
  for (; out.steps < 60 && s.step(1); ++out.steps) {
    out.gain = std::max(out.gain, s.observe().find("energy.total").value() - start);
    const auto x = s.state().systems[0].f64(0);
    for (size_t i = 0; i < x.size() / 3; ++i) {
      const Vec3 p = load3(x.data(), i);
      const double above = std::min(p.y, norm(p - Vec3{0, 0.6, 0}) - 0.3) - 0.01;
      out.deepest = std::max(out.deepest, -above);
    }
  }
  return out;
}

// 49 points of 20 g fall by some 0.4 m: 4 J at work.
TEST(ClothOnColliders, StiffSheetsGainNothing) {
  for (const double stiffness : {300.0, 1e4, 1e6, 1e8}) {
    const Fall f = fall(stiffness);
    EXPECT_EQ(f.steps, 60) << stiffness;
    EXPECT_LT(f.gain, 0.08) << stiffness;
    EXPECT_LT(f.deepest, 0.015) << stiffness << ": what stiff sheets wait with is less than their thickness";
  }
  // The control: a method without support for contacts has its points moved back to the surface after each
  // step, and cannot handle the springs that this stretches.
  EXPECT_LT(fall(1e4, R"(, "integrator": "bdf2")").steps, 60);
}

}  // namespace
}  // namespace truestep
