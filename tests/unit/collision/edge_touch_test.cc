// Edges of bodies against lines between points: the common perpendicular, the side that is kept, and ribbons
// and ropes whose points never touch what they hang over.
#include "engine/couplings/contact/edge_touch.h"

#include <cmath>

#include "engine/base/random.h"
#include "engine/kernels/contact/edge_edge.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

Vec3 random_point(uint64_t stream, uint64_t i) {
  const auto u = uniform4(31, stream, i);
  return {2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1};
}

TEST(EdgeEdge, IsTheCommonPerpendicular) {
  int found = 0;
  for (uint64_t i = 0; i < 300; ++i) {
    const Vec3 a0 = random_point(1, i), a1 = random_point(2, i), b0 = random_point(3, i),
               b1 = random_point(4, i);
    const auto n = nearest_inside(a0, a1, b0, b1);
    double least = 1e9;  // of places on a grid over both: never nearer
    for (int k = 0; k <= 20; ++k) {
      for (int l = 0; l <= 20; ++l) {
        least = std::min(least, norm(a0 + (a1 - a0) * (k / 20.0) - b0 - (b1 - b0) * (l / 20.0)));
      }
    }
    if (!n) continue;
    ++found;
    EXPECT_NEAR(dot(n->apart, a1 - a0), 0, 1e-13);
    EXPECT_NEAR(dot(n->apart, b1 - b0), 0, 1e-13);
    EXPECT_LE(norm(n->apart), least + 1e-12);
    EXPECT_LT(norm(a0 + (a1 - a0) * n->a - b0 - (b1 - b0) * n->b - n->apart), 1e-14);
  }
  EXPECT_GT(found, 30);
  EXPECT_FALSE(nearest_inside({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}).has_value());
}

TEST(EdgeTouch, KeepsTheSideOfTheStart) {
  using contact::edges_meet;
  const Vec3 up{0, 1, 0};
  const contact::MovingEdge ridge{{0, 0, -1}, {0, 0, 1}, {0, 0, -1}, {0, 0, 1}};
  const auto line = [](double y0, double y1) {
    return contact::MovingEdge{{-1, y0, 0.2}, {1, y0, 0.2}, {-1, y1, 0.2}, {1, y1, 0.2}};
  };
  const auto comes = edges_meet(line(0.1, 0.01), ridge, up, 0.02, 0.04);
  ASSERT_TRUE(comes.has_value());
  EXPECT_EQ(comes->n, up);
  EXPECT_NEAR(comes->s, 0.08 / 0.09, 1e-12);
  EXPECT_NEAR(comes->along, 0.5, 1e-15);
  const auto passes = edges_meet(line(0.1, -0.05), ridge, up, 0.02, 0.04);
  ASSERT_TRUE(passes.has_value());
  EXPECT_EQ(passes->n, up);
  // Far away, or from behind: no meeting.
  EXPECT_FALSE(edges_meet(line(0.1, 0.05), ridge, up, 0.02, 0.04).has_value());
  EXPECT_FALSE(edges_meet(line(-0.01, 0.01), ridge, up, 0.02, 0.04).has_value());
  // An axis has no back side.
  EXPECT_TRUE(edges_meet(line(-0.1, -0.01), ridge, {}, 0.02, 0.04).has_value());
}

constexpr double kRidge = 0.3 * 1.4142135623730951;
const std::string kBox =
    R"({"type": "box", "half_extents": [0.3, 0.3, 1], "axis": [0, 0, 1], "angle": 0.7853981633974483)";
const std::string kCapsule =
    R"({"type": "capsule", "radius": 0.1, "half_length": 1, "axis": [1, 0, 0], "angle": 1.5707963267948966, "position": [0, 0.3242640687119285, 0])";
// Points at x = -0.75, -0.25, 0.25 and 0.75: none is where the ridge is, and the ribbon is narrower than it.
const std::string kRibbon =
    R"({"type": "mass_spring", "id": "a", "cloth_grid": {"origin": [-0.75, 0.6, 0.4], "edge_u": [1.5, 0, 0], "edge_v": [0, 0, 0.2],
        "nx": 4, "ny": 2}, "mass": 0.05, "stiffness": 3000, "internal_damping": 1, "thickness": 0.04, "integrator": "velocity_verlet")";
const std::string kRope =
    R"({"type": "mass_spring", "id": "a", "rope": {"from": [-0.75, 0.6, 0.4], "to": [0.75, 0.6, 0.4], "links": 3},
        "mass": 0.05, "stiffness": 3000, "internal_damping": 1, "thickness": 0.04, "integrator": "velocity_verlet")";

std::string over(const std::string& points, const std::string& body, const char* gravity) {
  return R"({"gravity": )" + std::string(gravity) + R"(, "time": {"dt": 0.002}, "systems": [)" + points +
         R"(}, {"type": "rigid3d", "id": "b", "bodies": [)" + body +
         R"(}]}], "couplings": [{"type": "contact", "id": "c", "a": "a", "b": "b", "friction": 1, "restitution": 0}]})";
}

/// Least height over x = 0 of the lines between the two middle points along x.
double height_over_ridge(const SceneRun& run) {
  const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
  double least = 1e9;
  for (size_t i = 1; i < p.count; i += 4) {
    const Vec3 a = p.place(i), b = p.place(i + 1);
    least = std::min(least, a.y + (b.y - a.y) * (-a.x / (b.x - a.x)));
  }
  return least;
}

// The ridge touches no point, and no corner of the body lies under the ribbon: only lines and the edge meet.
// A search without edges would let the ridge through, down to where the points rest on the sides, 0.2 m
// lower.
TEST(EdgeTouch, NothingHangsThroughARidge) {
  for (const std::string& points : {kRibbon, kRope}) {
    for (const std::string& body : {kBox, kCapsule}) {
      SceneRun run(over(points, body + R"(, "motion": "fixed")", "[0, -9.81, 0]"));
      for (int k = 0; k < 600; ++k) {
        run.session.step(1);
        ASSERT_GT(height_over_ridge(run), kRidge + 0.02 - 1e-3) << k << points << body;
      }
      EXPECT_GT(run.observe("c.impulse.y") * -1, 0.5) << points << body;
    }
  }
}

TEST(EdgeTouch, KeepsMomentum) {
  SceneRun run(over(kRibbon + R"(, "velocity": [0, -2, 0])",
                    kBox + R"(, "mass": 2, "angular_velocity": [0.1, 0.2, 0.1])", "[0, 0, 0]"));
  const auto sums = [&] {
    const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
    const ConstBodies b(run.session.state().systems[1], *run.world->system(1).ports().bodies);
    Vec3 linear = b.velocity(0) * 2.0;
    Vec3 angular =
        cross(b.place(0), linear) + free_rotation::momentum({b.orientation(0), b.spin(0)}, b.form(0).moments);
    for (size_t i = 0; i < p.count; ++i) {
      const Vec3 m = p.velocity(i) / p.inverse_mass(i);
      linear += m, angular += cross(p.place(i), m);
    }
    return std::pair{linear, angular};
  };
  const auto before = sums();
  run.session.step(300);
  const auto after = sums();
  EXPECT_GT(run.observe("c.impulse.sum"), 0.2);
  EXPECT_LT(norm(after.first - before.first), 1e-12);
  EXPECT_LT(norm(after.second - before.second), 1e-11);
}

}  // namespace
}  // namespace truestep
