// Hulls from points and masses of solids: closed forms against polyhedra and numerical quadrature.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/geometry/mass_properties.h"
#include "tests/unit/collision/collision_rig.h"

namespace truestep {
namespace {

using namespace collision_rig;

void expect_same(const MassProperties& a, const MassProperties& b, double relative) {
  const double i = a.inertia.xx + a.inertia.yy + a.inertia.zz;
  EXPECT_NEAR(a.mass, b.mass, relative * a.mass);
  EXPECT_LT(norm(a.center - b.center), relative * std::sqrt(i / a.mass));
  EXPECT_NEAR(a.inertia.xx, b.inertia.xx, relative * i);
  EXPECT_NEAR(a.inertia.yy, b.inertia.yy, relative * i);
  EXPECT_NEAR(a.inertia.zz, b.inertia.zz, relative * i);
  EXPECT_NEAR(a.inertia.xy, b.inertia.xy, relative * i);
  EXPECT_NEAR(a.inertia.xz, b.inertia.xz, relative * i);
  EXPECT_NEAR(a.inertia.yz, b.inertia.yz, relative * i);
}

/// Corners of a box, moved, with points inside, on its faces and on its edges, some twice.
std::vector<Vec3> box_points(const Vec3& h, const Transform& at, double size) {
  std::vector<Vec3> p;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        p.push_back(at.point(Vec3{h.x * x, h.y * y, h.z * z} * 0.5) * size);
        if (x == y) p.push_back(p.back());
      }
    }
  }
  return p;
}

/// Closed, convex, every edge shared by two faces, every point inside.
void expect_sound(const Hull& h, const std::vector<Vec3>& points, double size) {
  size_t corners = 0;
  for (const HullFace& f : h.faces) {
    corners += f.count;
    EXPECT_NEAR(norm(f.normal), 1, 1e-12);
    EXPECT_GT(f.offset, dot(f.normal, h.center));
    for (const Vec3& p : points) EXPECT_LE(dot(f.normal, p) - f.offset, 3e-9 * size);
  }
  EXPECT_EQ(corners, 2 * h.edges.size());
  EXPECT_EQ(h.vertices.size() + h.faces.size(), h.edges.size() + 2);  // Euler
  for (const HullEdge& e : h.edges) EXPECT_NE(e.left, e.right);
}

TEST(ConvexHull, BoxWithPointsEverywhereHasSixFaces) {
  for (uint64_t i = 0; i < 20; ++i) {
    for (const double size : {1.0, 1e-3, 1e3}) {
      const auto points = box_points({1, 0.7, 0.3}, i == 0 ? Transform{} : random_transform(1, i, 1), size);
      const Hull h = convex_hull(points);
      EXPECT_EQ(h.vertices.size(), 8u);
      EXPECT_EQ(h.faces.size(), 6u);
      EXPECT_EQ(h.edges.size(), 12u);
      expect_sound(h, points, size);
    }
  }
}

TEST(ConvexHull, RandomSpheresPrismsAndNeedles) {
  for (uint64_t i = 0; i < 60; ++i) {
    std::vector<Vec3> points;
    const size_t n = 5 + 7 * (i % 20);
    for (uint64_t k = 0; k < n; ++k) {
      const Vec3 d = random_unit(20 + i, k);
      switch (i % 3) {
        case 0:
          points.push_back(d);
          break;
        case 1: {  // regular prism: cocircular points on two planes
          const double phi = 6.283185307179586 * static_cast<double>(k) / static_cast<double>(n);
          points.push_back({std::cos(phi), 0.5, std::sin(phi)});
          points.push_back({std::cos(phi), -0.5, std::sin(phi)});
          break;
        }
        default:
          points.push_back({d.x, d.y * 1e-4, d.z * 1e-3});
      }
    }
    const Hull h = convex_hull(points);
    expect_sound(h, points, 1);
    if (i % 3 == 0) {
      EXPECT_EQ(h.vertices.size(), n);
    }
    if (i % 3 == 1) {
      EXPECT_EQ(h.vertices.size(), 2 * n);
      EXPECT_EQ(h.faces.size(), n + 2);
    }
  }
}

TEST(ConvexHull, SaysWhatIsWrong) {
  const auto code = [](const std::vector<Vec3>& p) {
    try {
      convex_hull(p);
    } catch (const Error& e) {
      return e.code();
    }
    return std::string();
  };
  EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), "bad_hull");
  EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), "bad_hull");
  EXPECT_EQ(code({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}}), "bad_hull");
  EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, NAN}}), "bad_hull");
  // Found by fuzzing: a sliver whose faces merge into one plane; a thicker one is a hull.
  EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1e-11}}), "bad_hull");
  EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1e-6}}), "");
  EXPECT_THROW(box_solid({1, 0, 1}), Error);
  EXPECT_THROW(sphere_solid(-1), Error);
  EXPECT_THROW(mass_properties(plane_solid({0, 2, 0}), 1), Error);
}

TEST(MassProperties, BoxAsHullAsMeshAndInPieces) {
  const Vec3 h{0.5, 0.8, 1.1};
  const auto box = mass_properties(box_solid(h), 700);
  EXPECT_NEAR(box.mass, 700 * 8 * h.x * h.y * h.z, 1e-10);
  const Transform at = random_transform(3, 1, 5);
  expect_same(placed(box, at), mass_properties(hull_solid(box_points(h, at, 1)), 700), 1e-12);

  const Hull hull = convex_hull(box_points(h, at, 1));
  std::vector<uint32_t> triangles;
  for (const HullFace& f : hull.faces) {
    for (uint32_t k = 1; k + 1 < f.count; ++k) {
      for (const uint32_t c : {0u, k, k + 1}) triangles.push_back(hull.loops[f.first + c]);
    }
  }
  expect_same(placed(box, at), mass_properties(mesh_solid(hull.vertices, triangles), 700), 1e-12);
  std::swap(triangles[0], triangles[1]);
  EXPECT_THROW(mass_properties(mesh_solid(hull.vertices, triangles), 700), Error);

  const Vec3 half{h.x, h.y / 2, h.z};
  const Solid two =
      compound_solid({{box_solid(half), {{0, h.y / 2, 0}, {}}}, {box_solid(half), {{0, -h.y / 2, 0}, {}}}});
  expect_same(box, mass_properties(two, 700), 1e-14);
}

/// Solids of revolution about y, disc by disc (midpoint rule): dm = rho pi r^2 dy.
MassProperties by_discs(double half, double (*radius2)(double y), double density) {
  MassProperties p;
  constexpr int kDiscs = 200000;
  const double dy = 2 * half / kDiscs;
  for (int i = 0; i < kDiscs; ++i) {
    const double y = -half + (i + 0.5) * dy, r2 = radius2(y), m = density * 3.141592653589793 * r2 * dy;
    p.mass += m;
    p.inertia.yy += m * r2 / 2;
    p.inertia.xx += m * (r2 / 4 + y * y);
  }
  p.inertia.zz = p.inertia.xx;
  return p;
}

TEST(MassProperties, RoundSolidsAgainstDiscs) {
  // Midpoint rule over 2e5 discs: better than 1e-9 for smooth profiles, 1e-7 with kinks and vertical
  // tangents.
  expect_same(mass_properties(sphere_solid(0.7), 3),
              by_discs(
                  0.7, [](double y) { return 0.49 - y * y; }, 3),
              1e-7);
  expect_same(mass_properties(cylinder_solid(0.3, 0.9), 3),
              by_discs(
                  0.9, [](double) { return 0.09; }, 3),
              1e-7);
  const auto capsule = [](double y) {
    const double e = std::fabs(y) - 0.5;
    return e < 0 ? 0.16 : 0.16 - e * e;
  };
  expect_same(mass_properties(capsule_solid(0.4, 0.5), 3), by_discs(0.9, capsule, 3), 1e-7);
  // Control: a capsule without the lever arm of the half balls (3 h r / 4) is detected.
  auto wrong = mass_properties(capsule_solid(0.4, 0.5), 3);
  wrong.inertia.xx -= 3 * (4.0 / 3) * 3.141592653589793 * 0.064 * 0.75 * 0.5 * 0.4;
  EXPECT_GT(std::fabs(wrong.inertia.xx - by_discs(0.9, capsule, 3).inertia.xx), 1e-3 * wrong.inertia.xx);
}

TEST(MassProperties, PrincipalAxesDiagonalise) {
  for (uint64_t i = 0; i < 200; ++i) {
    const auto u = uniform4(6, 6, i);
    const Symmetric3 d{1 + u[0], 1 + u[1], i % 5 == 0 ? 1 + u[1] : 1 + u[2], 0, 0, 0};
    const Rotation r = rotation(random_quat(7, i));
    const MassProperties turned = placed({1, {}, d}, {r, {}});
    const PrincipalAxes p = principal_axes(turned.inertia);
    const MassProperties back =
        placed({1, {}, {p.moments.x, p.moments.y, p.moments.z, 0, 0, 0}}, {rotation(p.axes), {}});
    expect_same(turned, back, 1e-14);
  }
  EXPECT_EQ(principal_axes({3, 2, 1, 0, 0, 0}).axes, Quat{});
}

}  // namespace
}  // namespace truestep
