#include "engine/collision/points/collider_set.h"

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/collision/points/collider_def.h"

namespace truestep {
namespace {

constexpr double kG = 9.81;

/// One or more points under gravity, stepped exactly (parabolas) or by symplectic Euler, with contacts.
struct Flight {
  enum class Method { exact, symplectic_euler } method = Method::exact;
  std::vector<double> x, v;
  double t = 0, h = 1.0 / 240;
  ColliderSet set;
  double radius = 0;
  Vec3 g{0, -kG, 0};
  Workspace workspace;
  ThreadArena arena{1};

  void step() {
    const std::vector<double> x0 = x, v0 = v;
    const double a[3] = {g.x, g.y, g.z};
    for (size_t i = 0; i < x.size(); ++i) {
      v[i] += h * a[i % 3];
      x[i] += method == Method::exact ? h * v0[i] + 0.5 * h * h * a[i % 3] : h * v[i];
    }
    ContactSweep sweep{t, h, x0, v0, x, v};
    sweep.radius = radius;
    set.resolve(sweep, workspace, arena);
    t += h;
  }
};

Collider plane(Vec3 normal, double e, double mu) {
  Collider c;
  c.shape = {ShapeKind::plane, PointSide::outside, normalized(normal)};
  c.surface = {e, mu, 0.01};
  return c;
}

/// Peak heights after each bounce of a ball dropped from 1 m; a control with another e must differ.
std::vector<double> peaks(Flight::Method method, double e, int count) {
  Flight f;
  f.method = method;
  f.x = {0, 1, 0}, f.v = {0, 0, 0};
  f.set.add(plane({0, 1, 0}, e, 0));
  std::vector<double> out;
  double before = 0, last = f.x[1];
  while (out.size() < static_cast<size_t>(count) && f.t < 20) {
    f.step();
    if (last > before && last > f.x[1] && f.t > 0.2) {
      // Vertex of the parabola through three samples.
      const double d1 = last - before, d2 = f.x[1] - last;
      out.push_back(last + (d1 + d2) * (d1 + d2) / (8 * (d1 - d2)));
    }
    before = last, last = f.x[1];
  }
  return out;
}

TEST(ColliderSet, BounceHeightsAreAGeometricSeries) {
  const double e = 0.8;
  for (const auto method : {Flight::Method::exact, Flight::Method::symplectic_euler}) {
    const auto h = peaks(method, e, 6);
    ASSERT_EQ(h.size(), 6u);
    // Exact parabolas leave rounding and the slop of 1e-9 m (1e-8 of the last height); symplectic Euler
    // follows a slightly different parabola from a start at rest, off by g h^2 / 8 = 2e-5 m of the first
    // height.
    const double tolerance = method == Flight::Method::exact ? 2e-8 : 1e-4;
    for (int n = 0; n < 6; ++n) {
      const double expected = std::pow(e, 2 * (n + 1));
      EXPECT_NEAR(h[n], expected, tolerance) << n;
      EXPECT_GT(std::fabs(h[n] - std::pow(0.79, 2 * (n + 1))), tolerance);  // control: another e fails
    }
  }
}

TEST(ColliderSet, ElasticBounceKeepsItsHeightForAThousandBounces) {
  Flight f;
  f.x = {0, 1, 0}, f.v = {0, 0, 0};
  f.set.add(plane({0, 1, 0}, 1, 0));
  double top = 0;
  for (int k = 0; k < 240 * 900; ++k) {
    f.step();
    if (k > 240 * 890) top = std::max(top, 0.5 * f.v[1] * f.v[1] + kG * f.x[1]);
  }
  EXPECT_NEAR(top, kG, 1e-4);  // 1000 bounces, each shifts the energy by at most g * 1e-9 m * 10
}

TEST(ColliderSet, RestsWithoutJitter) {
  for (const auto method : {Flight::Method::exact, Flight::Method::symplectic_euler}) {
    Flight f;
    f.method = method;
    f.radius = 0.1;
    f.x = {0, 0.5, 0}, f.v = {0.3, 0, 0};
    f.set.add(plane({0, 1, 0}, 0.6, 0.5));
    for (int k = 0; k < 240 * 6; ++k) f.step();
    const auto x = f.x;
    for (int k = 0; k < 240; ++k) {
      f.step();
      EXPECT_EQ(f.x, x);
      EXPECT_EQ(f.v, (std::vector<double>{0, 0, 0}));
    }
    EXPECT_NEAR(x[1], 0.1, 3e-9);
  }
}

TEST(ColliderSet, SlidesToAStopAtTheClosedFormDistance) {
  for (const auto method : {Flight::Method::exact, Flight::Method::symplectic_euler}) {
    Flight f;
    f.method = method;
    f.x = {0, kContactSlop, 0}, f.v = {3, 0, 0};
    f.set.add(plane({0, 1, 0}, 0.5, 0.4));
    for (int k = 0; k < 240; ++k) f.step();
    EXPECT_NEAR(f.x[0], 1.146788990825688, 1e-9);  // v^2 / (2 mu g); control: 0.41 stops 28 mm earlier
    EXPECT_EQ(f.v[0], 0);
  }
}

TEST(ColliderSet, InclineOfThirtyDegrees) {
  for (const auto method : {Flight::Method::exact, Flight::Method::symplectic_euler}) {
    for (const double mu : {0.3, 0.6}) {
      Flight f;
      f.method = method;
      f.set.add(plane({0.5, std::sqrt(0.75), 0}, 0, mu));
      const Vec3 n = f.set.colliders()[0].shape.size, start = n * kContactSlop;
      f.x = {start.x, start.y, start.z}, f.v = {0, 0, 0};
      for (int k = 0; k < 240; ++k) f.step();
      const double slid = norm(Vec3{f.x[0], f.x[1], f.x[2]} - start);
      // mu 0.3 slides g (sin - mu cos) / 2 = 1.178143618... (exactly for parabolas, symplectic Euler adds
      // a h / 2 to the distance of 1 s); mu 0.6 > tan 30 does not creep at all.
      const double first_order = method == Flight::Method::exact ? 0 : 2.356287 / 240 / 2;
      if (mu < 0.5) {
        EXPECT_NEAR(slid, 1.178143618331198531, first_order + 1e-8);
      } else {
        EXPECT_EQ(slid, 0);
      }
    }
  }
}

TEST(ColliderSet, NothingFastTunnelsThroughThinSolids) {
  // A wall 0.1 mm thick and a tilted one, crossed by up to 300 m in one step.
  const int n = 100000;
  ColliderDefs defs;
  BoxColliderDef wall;
  wall.half_extents = {0.00005, 1e4, 1e4};
  defs.push_back(wall);
  const ColliderSet box = build_colliders(defs);
  wall.axis = {0, 0.3, 1}, wall.angle = 0.7, wall.center = {0.2, 0, 0};
  wall.motion = MotionDef{{5, 0, 0}, {}, {0, 0, 0}};
  const ColliderSet tilted = build_colliders({wall});
  const double h = 0.01;
  for (const ColliderSet* set : {&box, &tilted}) {
    std::vector<double> x0, v0, x1;
    const Pose at0 = moved(set->colliders()[0].start, set->colliders()[0].motion, 0);
    const Rotation r = rotation(at0.orientation);
    for (int i = 0; i < n; ++i) {
      const auto u = uniform4(3, 1, i), w = uniform4(3, 2, i);
      // Starts left of the wall (in its frame), from touching to far; any direction, speed up to 30 km/s.
      const Vec3 p =
          at0.position + r.apply({-0.0001 - 10 * u[0] * u[0] * u[0], 20 * u[1] - 10, 20 * u[2] - 10});
      const double speed = 30000 * u[3] * u[3] * u[3];
      const Vec3 v = normalized(Vec3{2 * w[0] - 1, 2 * w[1] - 1, 2 * w[2] - 1}) * speed;
      for (const double c : {p.x, p.y, p.z}) x0.push_back(c);
      for (const double c : {v.x, v.y, v.z}) v0.push_back(c);
    }
    x1 = x0;
    for (size_t i = 0; i < x1.size(); ++i) x1[i] += h * v0[i];
    std::vector<double> free = x1, v = v0;
    Workspace workspace;
    set->resolve({0, h, x0, v0, x1, v}, workspace, ThreadArena(1));
    const Pose at1 = moved(set->colliders()[0].start, set->colliders()[0].motion, h);
    const Rotation q = rotation(at1.orientation);
    int missed = 0, crossing = 0;
    for (int i = 0; i < n; ++i) {
      missed += q.apply_inverse(load3(x1.data(), i) - at1.position).x > 0;
      crossing += q.apply_inverse(load3(free.data(), i) - at1.position).x > 0;
    }
    EXPECT_EQ(missed, 0);
    EXPECT_GT(crossing, n / 4);  // control: without contacts this many pass
  }
}

TEST(ColliderSet, ContainersHoldEverything) {
  const char* const names[] = {"box", "turned box", "sphere", "capsule"};
  for (int kind = 0; kind < 4; ++kind) {
    ColliderDefs defs;
    if (kind < 2) {
      BoxColliderDef d;
      d.container = true, d.half_extents = {1, 0.5, 0.8}, d.angle = kind * 0.4, d.axis = {1, 1, 0};
      defs.push_back(d);
    } else if (kind == 2) {
      SphereColliderDef d;
      d.container = true, d.radius = 1;
      d.motion = MotionDef{{}, {0.3, 0, 0}, {0, 0, 3}, 2, 0.5};
      defs.push_back(d);
    } else {
      CapsuleColliderDef d;
      d.container = true, d.radius = 0.5, d.motion = MotionDef{{}, {}, {0, 2, 0}};
      defs.push_back(d);
    }
    Flight f;
    f.set = build_colliders(defs);
    for (int i = 0; i < 300; ++i) {
      const auto u = uniform4(5, 1, i), w = uniform4(5, 2, i);
      for (int k = 0; k < 3; ++k) f.x.push_back(0.4 * (2 * u[k] - 1)), f.v.push_back(40 * (2 * w[k] - 1));
    }
    double worst = 1;
    for (int k = 0; k < 600; ++k) {
      f.step();
      for (size_t i = 0; i < 300; ++i) worst = std::min(worst, f.set.clearance(load3(f.x.data(), i), f.t));
    }
    EXPECT_GE(worst, -1e-12) << names[kind];
  }
}

TEST(ColliderSet, AMovingPaddleHitsLikeTheFormula) {
  // A wall with speed u and restitution e gives a resting point the speed (1 + e) u.
  PlaneColliderDef d;
  d.normal = {1, 0, 0}, d.point = {-0.1, 0, 0}, d.restitution = 0.5, d.friction = 0;
  d.motion = MotionDef{{4, 0, 0}, {}, {}};
  Flight f;
  f.g = {};
  f.set = build_colliders({d});
  f.x = {0, 0, 0}, f.v = {0, 0, 0};
  for (int k = 0; k < 24; ++k) f.step();
  EXPECT_NEAR(f.v[0], 6, 1e-12);
  // Hit at t = 0.025 s at x = 0 (up to the slop), then 0.075 s at 6 m/s.
  EXPECT_NEAR(f.x[0], 0.075 * 6, 1e-8);
}

TEST(ColliderSet, ASpinningDrumDragsAlong) {
  // A point slides inside a drum of radius R that rotates at 2 rad/s, without gravity: the wall presses with
  // v^2/R and rubs with mu v^2/R, so 1/v falls by mu t / R until v is the wall's speed.
  SphereColliderDef d;
  d.container = true, d.radius = 1, d.restitution = 0, d.friction = 0.8;
  d.motion = MotionDef{{}, {}, {0, 0, 2}};
  Flight f;
  f.g = {};
  f.set = build_colliders({d});
  f.x = {0, -1 + kContactSlop, 0}, f.v = {1.25, 0, 0};
  const double t = 60 * f.h;
  for (int k = 0; k < 60; ++k) f.step();
  // First order in h = 1/240 s: v mu h / R is 0.4 % of the change.
  EXPECT_NEAR(norm(load3(f.v.data(), 0)), 1 / (1 / 1.25 - 0.8 * t), 0.01);
  EXPECT_GT(norm(load3(f.v.data(), 0)), 1 / (1 / 1.25 - 0.7 * t) + 0.01);  // control: mu = 0.7 is not it
  for (int k = 0; k < 240; ++k) f.step();
  EXPECT_NEAR(norm(load3(f.v.data(), 0)), 2, 1e-4);
}

TEST(ColliderSet, AMarbleInAFrictionlessBowlKeepsItsEnergy) {
  SphereColliderDef d;
  d.container = true, d.radius = 1, d.restitution = 0, d.friction = 0;
  for (const double h : {1.0 / 240, 1.0 / 960}) {
    Flight f;
    f.h = h;
    f.set = build_colliders({d});
    f.x = {-std::sqrt(0.75), -0.5, 0}, f.v = {0, 0, 0};
    const double before = kG * f.x[1];
    for (int k = 0; k * h < 4; ++k) f.step();
    const double after = 0.5 * norm2(load3(f.v.data(), 0)) + kG * f.x[1];
    // The wall does no work: rounding and the slop of 1e-9 m per contact, 1e3 contacts.
    EXPECT_NEAR(after, before, 2e-4);
  }
}

TEST(ColliderSet, SameBitsForAnyNumberOfThreads) {
  std::vector<double> reference;
  for (const int threads : {1, 2, 4}) {
    Flight f;
    f.set.add(plane({0.1, 1, 0}, 0.7, 0.2));
    std::vector<double> x, v;
    for (int i = 0; i < 10000; ++i) {
      const auto u = uniform4(9, 1, i);
      for (int k = 0; k < 3; ++k) x.push_back(u[k]), v.push_back(0);
    }
    const ThreadArena arena(threads);
    for (int s = 0; s < 100; ++s) {
      const auto x0 = x, v0 = v;
      for (size_t i = 0; i < x.size(); ++i) {
        if (i % 3 == 1) v[i] -= kG * 0.01;
        x[i] += 0.01 * v[i];
      }
      f.set.resolve({s * 0.01, 0.01, x0, v0, x, v}, f.workspace, arena);
      f.workspace.clear();
    }
    if (reference.empty()) reference = x;
    EXPECT_EQ(reference, x);
  }
}

}  // namespace
}  // namespace truestep
