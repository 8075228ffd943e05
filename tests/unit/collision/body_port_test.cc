// Points and bodies through their ports: the effect of an impulse, single precision, faces that nothing
// passes. (Momenta, hooks, bounces, slopes and rejected sides are in tests/scenes.)
#include <cmath>

#include "engine/base/random.h"
#include "engine/collision/point_distance.h"
#include "engine/collision/queries/queries.h"
#include "engine/couplings/points_on_bodies.h"
#include "engine/kernels/contact/point_hull.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

Vec3 random_vec(uint64_t stream, uint64_t i) {
  const auto u = uniform4(23, stream, i);
  return {2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1};
}

constexpr const char* kTumbling = R"({"gravity": [0, 0, 0], "time": {"dt": 0.004}, "systems": [
    {"type": "rigid3d", "id": "a", "bodies": [{"type": "box", "half_extents": [0.3, 0.2, 0.1], "mass": 3,
      "position": [1, 2, 3], "axis": [1, 2, 3], "angle": 0.7, "velocity": [1, 0, -1], "angular_velocity": [2, 1, -3]}]}]})";

TEST(BodyPort, ImpulsesAndCorrectionsKeepMomentum) {
  SceneRun run(kTumbling);
  State state = run.session.state().systems[0];
  const BodyPort port = *run.world->system(0).ports().bodies;
  Bodies bodies(state, port);
  State cloud;
  cloud.add({"position", "m", Scalar::f64, 3, Role::position}, 3);
  cloud.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, 3);
  cloud.add({"mass", "kg"}, 3);
  for (size_t i = 0; i < 3; ++i) {
    store3(cloud.f64(0).data(), i, Vec3{1, 2, 3} + random_vec(1, i) * 0.5);
    store3(cloud.f64(1).data(), i, random_vec(2, i));
    cloud.f64(2)[i] = 0.1 * (1 + double(i));
  }
  Points points(cloud, {.mass = 2, .inverse_mass = {}, .id = {}});
  const auto sums = [&] {
    Vec3 p = bodies.velocity(0) * 3.0;
    Vec3 l = cross(bodies.place(0), p) +
             free_rotation::momentum({bodies.orientation(0), bodies.spin(0)}, port.forms[0].moments);
    for (size_t i = 0; i < 3; ++i) {
      const Vec3 m = points.velocity(i) / points.inverse_mass(i);
      p += m, l += cross(points.place(i), m);
    }
    return std::pair{p, l};
  };
  const auto before = sums();
  for (uint64_t k = 0; k < 100; ++k) {
    BodyLink link{{0, 1, 2}, {0.2, 0.3, 0.5}, 3, 0};
    const Vec3 u = link.relative(points, bodies), j = random_vec(3, k) * 0.1;
    const Vec3 arm = link.arm(points, bodies);
    const Vec3 expected = u + j * link.inverse_mass(points) + bodies.answer(0, arm, j);
    link.push(points, bodies, j);
    EXPECT_LT(norm(link.relative(points, bodies) - expected), 1e-12);
    link.shift(points, bodies, random_vec(4, k) * 1e-3);
  }
  const auto after = sums();
  EXPECT_LT(norm(after.first - before.first), 1e-12 * 10);
  EXPECT_LT(norm(after.second - before.second), 1e-12 * 100);
}

TEST(BodyPort, AnImpulseWakesASleepingBody) {
  SceneRun run(R"({"time": {"dt": 0.004}, "systems": [{"type": "rigid3d", "id": "a", "bodies": [
      {"type": "box", "position": [0, 0.5, 0]}, {"type": "plane", "motion": "fixed"}]}]})");
  run.session.step(500);
  State state = run.session.state().systems[0];
  const auto asleep = *state.find("asleep");
  ASSERT_EQ(state.span<uint32_t>(asleep)[0], 1u);
  const BodyPort port = *run.world->system(0).ports().bodies;
  Bodies bodies(state, port);
  // A static body takes no impulse and wakes nothing.
  bodies.push(1, {}, {1, 0, 0});
  EXPECT_EQ(state.span<uint32_t>(asleep)[0], 1u);
  bodies.push(0, {}, {1, 0, 0});
  EXPECT_EQ(state.span<uint32_t>(asleep)[0], 0u);
}

TEST(PointPort, SinglePrecisionColumnsAreReadAndWritten) {
  State s;
  s.add({"position", "m", Scalar::f32, 3, Role::position}, 2);
  s.add({"velocity", "m/s", Scalar::f32, 3, Role::velocity}, 2);
  s.add({"inverse_mass", "1/kg", Scalar::f32}, 2);
  s.span<float>(2)[1] = 4;
  Points points(s, {.mass = {}, .inverse_mass = 2, .id = {}});
  EXPECT_EQ(points.x, nullptr);
  points.set_place(1, {1, 2, 3}), points.accelerate(1, {0.5, 0, 0});
  EXPECT_EQ(s.span<float>(0)[5], 3);
  EXPECT_EQ(s.span<float>(1)[3], 0.5f);
  EXPECT_EQ(points.inverse_mass(1), 4);
  std::vector<double> memory;
  points.copy_singles(memory);
  EXPECT_EQ(points.x[4], 2);
  points.x[4] = 7;
  points.write_back();
  EXPECT_EQ(s.span<float>(0)[4], 7);
}

// Against the queries of rigid bodies, which compute the same in another way.
TEST(PointDistance, IsThatOfTheCollisionQueries) {
  const std::vector<Vec3> corners{{-1, -1, -1}, {1, -1, -1}, {0, -1, 1}, {0, 1, 0}};
  const Solid solids[] = {sphere_solid(0.7),
                          box_solid({0.3, 0.5, 0.8}),
                          capsule_solid(0.3, 0.6),
                          cylinder_solid(0.5, 0.4),
                          hull_solid(corners),
                          plane_solid({0, 1, 0}),
                          compound_solid({{sphere_solid(0.4), {{0.6, 0, 0}, {}}},
                                          {box_solid({0.2, 0.2, 0.2}), {{-0.6, 0, 0}, {}}}})};
  for (const Solid& s : solids) {
    for (uint64_t i = 0; i < 200; ++i) {
      const Vec3 p = random_vec(9, i) * 2;
      const auto ours = point_distance(s, p, 1);
      const auto theirs = nearest_point(s, {}, p, 1);
      if (!ours || ours->distance < 0) continue;
      ASSERT_TRUE(theirs.has_value()) << int(s.kind) << " " << i;
      EXPECT_NEAR(ours->distance, theirs->distance, 1e-6) << int(s.kind) << " " << i;
      EXPECT_NEAR(norm(ours->normal), 1, 1e-12);
    }
  }
}

std::string storm(const char* law, double speed) {
  std::string x, v;
  for (uint64_t i = 0; i < 150; ++i) {
    const Vec3 p = random_vec(5, i), u = random_vec(6, i);
    char text[128];
    std::snprintf(text, sizeof text, "%s[%.4f, %.4f, %.4f]", i ? ", " : "", 2 * p.x, 2 * p.y + 3, 2 * p.z);
    x += text;
    std::snprintf(text, sizeof text, "%s[%.4f, %.4f, %.4f]", i ? ", " : "", u.x, -speed + u.y, u.z);
    v += text;
  }
  return R"({"gravity": [0, 0, 0], "time": {"dt": 0.004}, "systems": [
    {"type": "particles", "id": "dust", "mass": 0.01, "radius": 0.02, "positions": [)" +
         x + R"(], "velocities": [)" + v +
         R"(]}, {"type": "rigid3d", "id": "crate", "bodies": [{"type": "box", "half_extents": [1.5, 0.5, 1.5], "mass": 2,
      "angular_velocity": [1, 2, 0.5]}]}],
    "couplings": [{"type": "contact", "id": "c", "a": "dust", "b": "crate", )" +
         law + "}]}";
}

TEST(BodyContact, NothingFastPassesAThinPlate) {
  for (const double speed : {10.0, 100.0, 1000.0}) {
    std::string scene = storm(R"("restitution": 0, "friction": 0.3)", speed);
    const std::string thick = "[1.5, 0.5, 1.5]";
    scene.replace(scene.find(thick), thick.size(), "[9, 0.01, 9]");
    const std::string spin = "[1, 2, 0.5]";
    scene.replace(scene.find(spin), spin.size(), "[0, 0.2, 0]");
    SceneRun run(scene);
    const Ports dust = run.world->system(0).ports(), plate = run.world->system(1).ports();
    for (int k = 0; k < static_cast<int>(10 / speed / 0.004) + 10; ++k) {
      run.session.step(1);
      const ConstPoints p(run.session.state().systems[0], *dust.points);
      const ConstBodies b(run.session.state().systems[1], *plate.bodies);
      const Rotation r = rotation(b.orientation(0));
      for (size_t i = 0; i < p.count; ++i) {
        ASSERT_GT(r.apply_inverse(p.place(i) - b.place(0)).y, 0.01) << speed << " " << i << " step " << k;
      }
    }
    EXPECT_GT(run.observe("c.impulse.sum"), 0.1);
  }
}

// A corner comes down on a cloth of two triangles whose points it never meets.
TEST(BodyContact, CornersDoNotPassCoarseCloth) {
  SceneRun run(R"({"time": {"dt": 0.004, "substeps": 4}, "systems": [
      {"type": "mass_spring", "id": "cloth", "cloth_grid": {"origin": [-1, 0, -1], "edge_u": [2, 0, 0],
        "edge_v": [0, 0, 2], "nx": 3, "ny": 3}, "mass": 0.1, "stiffness": 2000, "pinned": ["border"], "thickness": 0.02,
        "integrator": "velocity_verlet"},
      {"type": "rigid3d", "id": "crate", "bodies": [{"type": "box", "half_extents": [0.15, 0.15, 0.15], "mass": 0.5,
        "position": [0.4, 0.4, 0.5], "axis": [1, 0, 1], "angle": 0.7}]}],
    "couplings": [{"type": "contact", "id": "c", "a": "cloth", "b": "crate"}]})");
  for (int k = 0; k < 400; ++k) {
    run.session.step(1);
    const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
    const ConstBodies b(run.session.state().systems[1], *run.world->system(1).ports().bodies);
    const Rotation r = rotation(b.orientation(0));
    for (int c = 0; c < 8; ++c) {
      const Vec3 at =
          b.place(0) + r.apply({c & 1 ? 0.15 : -0.15, c & 2 ? 0.15 : -0.15, c & 4 ? 0.15 : -0.15});
      for (const auto& t : run.world->system(0).ports().solids.triangles) {
        const std::array<Vec3, 3> x{p.place(t[0]), p.place(t[1]), p.place(t[2])};
        ASSERT_GT(norm(at - blend(x, nearest_on_hull(at, x, 3), 3)), 0.009) << k;
      }
    }
  }
  EXPECT_GT(run.observe("c.impulse.y"), 0.1);
}

}  // namespace
}  // namespace truestep
