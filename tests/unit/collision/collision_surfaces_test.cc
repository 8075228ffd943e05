// Planes, meshes, height fields and compounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/collision/pairs/collide.h"
#include "engine/collision/pairs/distance/gjk.h"
#include "engine/geometry/height_field.h"
#include "tests/unit/collision/collision_rig.h"

namespace truestep {
namespace {

using namespace collision_rig;

struct Ground {
  std::vector<Vec3> vertices;
  std::vector<uint32_t> triangles;
  std::vector<double> heights;
};

/// n x n heights 0.5 apart as a list of triangles, split like a height field's cells.
template <class Height>
Ground ground(size_t n, Height&& height) {
  Ground g;
  for (size_t j = 0; j < n; ++j) {
    for (size_t i = 0; i < n; ++i) {
      const double x = (static_cast<double>(i) - 0.5 * static_cast<double>(n - 1)) * 0.5,
                   z = (static_cast<double>(j) - 0.5 * static_cast<double>(n - 1)) * 0.5;
      g.heights.push_back(height(x, z));
      g.vertices.push_back({x, g.heights.back(), z});
    }
  }
  for (size_t j = 0; j + 1 < n; ++j) {
    for (size_t i = 0; i + 1 < n; ++i) {
      const auto at = [&](size_t a, size_t b) { return static_cast<uint32_t>(b * n + a); };
      for (const uint32_t k :
           {at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1), at(i + 1, j), at(i, j + 1)}) {
        g.triangles.push_back(k);
      }
    }
  }
  return g;
}

double deepest(const std::vector<Manifold>& all) {
  double d = -1e300;
  for (const Manifold& m : all) d = std::max(d, m.deepest());
  return d;
}

TEST(CollisionSurfaces, PlanesMeetTheLowestPoints) {
  for (int k = 0; k < kSolids; ++k) {
    for (uint64_t i = 0; i < 300; ++i) {
      const Solid plane = plane_solid(random_unit(31, i));
      const Transform at = random_transform(32, i, 3);
      const Vec3 n = at.direction(plane.size);
      Placed body{sample_solid(k, i, 1), random_transform(33, i, 1)};
      if (i % 4 == 0) body.at.rotation = at.rotation * rotation(quarter_turns(i / 4));
      const auto low = static_cast<double>(-reach(body, {-n.x, -n.y, -n.z}));
      // The lowest point ends 0.1 below or 0.02 above.
      body.at.position += n * (dot(n, at.position) - low + (i % 2 ? -0.1 : 0.02));
      Manifold m;
      ASSERT_TRUE(collide(plane, at, body.solid, body.at, 0.05, m));
      EXPECT_NEAR(-m.deepest(), i % 2 ? -0.1 : 0.02, 2e-4 * 1.0) << k << " " << i;
      EXPECT_LT(norm(m.normal - n), 1e-12);
      for (int p = 0; p < m.count; ++p) {
        EXPECT_LE(outside(body, m.points[p].position + n * (0.5 * m.points[p].separation)), 1e-9);
      }
      Manifold w;
      ASSERT_TRUE(collide(body.solid, body.at, plane, at, 0.05, w));
      EXPECT_LT(norm(w.normal + n), 1e-12);
      body.at.position += n * 0.2;
      EXPECT_FALSE(collide(plane, at, body.solid, body.at, 0.05, m));
    }
  }
}

TEST(CollisionSurfaces, BoxesAndCylindersStandOnFourPoints) {
  Manifold m;
  const Solid plane = plane_solid({0, 1, 0});
  for (const Solid& s : {box_solid({1, 1, 1}), cylinder_solid(1, 1)}) {
    ASSERT_TRUE(collide(plane, {}, s, {{}, {0, 0.999, 0}}, 0.01, m));
    EXPECT_EQ(m.count, 4);
    ASSERT_TRUE(collide(box_solid({3, 1, 3}), {{}, {0, -1, 0}}, s, {{}, {0.1, 0.999, 0.2}}, 0.01, m));
    EXPECT_EQ(m.count, 4);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(m.points[k].separation, -0.001, 1e-9);
  }
}

/// Bodies pressed slightly into flat ground anywhere on a mesh.
template <class Check>
void press_everywhere(const Solid& surface, Check&& check) {
  for (int k = 0; k < kSolids; ++k) {
    for (uint64_t i = 0; i < 60; ++i) {
      Placed body{sample_solid(k, i, 0.6), random_transform(41, i, 0)};
      const auto u = uniform4(42, 1, i);
      body.at.position = {3 * u[0] - 1.5, 0, 3 * u[1] - 1.5};
      if (i % 3 == 0) body.at.rotation = rotation(quarter_turns(i / 3));
      const auto low = static_cast<double>(-reach(body, {0, -1, 0}));
      // Not so deep that its centre goes under: bodies behind a surface are not pushed.
      const double depth = std::min(0.01, 0.3 * inner_radius(body.solid));
      body.at.position.y += -low - depth;
      std::vector<Manifold> all;
      collide(surface, {}, body.solid, body.at, 0.02, all);
      check(all, depth, k, i);
    }
  }
}

/// Every triangle with corners of its own, each a step (m) further along x than the one before.
Solid corners_repeated(const Ground& g, double step) {
  std::vector<Vec3> vertices;
  std::vector<uint32_t> triangles;
  for (const uint32_t k : g.triangles) {
    const double along = step * static_cast<double>(triangles.size() / 3);
    triangles.push_back(static_cast<uint32_t>(vertices.size()));
    vertices.push_back(g.vertices[k] + Vec3{along, 0, 0});
  }
  return mesh_solid(vertices, triangles);
}

// Nor where a file repeats its corners at the same place.
TEST(CollisionSurfaces, InnerEdgesOfFlatGroundAreNotFelt) {
  const Ground g = ground(11, [](double, double) { return 0.0; });
  for (const Solid& s : {mesh_solid(g.vertices, g.triangles), height_field_solid(11, 11, 0.5, g.heights),
                         corners_repeated(g, 0)}) {
    press_everywhere(s, [](const std::vector<Manifold>& all, double depth, int k, uint64_t i) {
      ASSERT_FALSE(all.empty()) << k << " " << i;
      EXPECT_NEAR(deepest(all), depth, 1e-4) << k << " " << i;
      for (const Manifold& m : all) EXPECT_GT(m.normal.y, 1 - 1e-7) << k << " " << i;
    });
  }
}

TEST(CollisionSurfaces, FlatGroundIsOneContactHoweverFine) {
  const Ground g = ground(21, [](double, double) { return 0.0; });
  for (const Solid& s : {mesh_solid(g.vertices, g.triangles), height_field_solid(21, 21, 0.5, g.heights)}) {
    std::vector<Manifold> all;
    collide(s, {}, box_solid({2.2, 0.5, 1.7}),
            {rotation(Quat{0.9, 0, 0.43588989435406735, 0}), {0.1, 0.499, 0.2}}, 0.01, all);
    ASSERT_EQ(all.size(), 1u);
    ASSERT_EQ(all[0].count, 4);
    // The four points span the face: its area is 4 2.2 1.7, of which they cover at least half.
    const Vec3 d = all[0].points[1].position - all[0].points[0].position;
    EXPECT_GT(norm(d), 3);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(all[0].points[k].separation, -0.001, 1e-12);
    EXPECT_NE(all[0].points[0].id, all[0].points[1].id);
  }
}

// The same triangles further apart than rounding do not know that they are flat.
TEST(CollisionSurfaces, ControlWithoutNeighboursEdgesAreFelt) {
  int leaning = 0;
  press_everywhere(corners_repeated(ground(11, [](double, double) { return 0.0; }), 1e-11),
                   [&](const std::vector<Manifold>& all, double, int, uint64_t) {
                     for (const Manifold& m : all) leaning += m.normal.y < 1 - 1e-7;
                   });
  EXPECT_GT(leaning, 100);
}

TEST(CollisionSurfaces, HeightFieldIsTheMeshOfItsCells) {
  const Ground g =
      ground(9, [](double x, double z) { return 0.3 * std::sin(3 * x) + 0.2 * std::cos(2 * z + x); });
  const Solid mesh = mesh_solid(g.vertices, g.triangles), field = height_field_solid(9, 9, 0.5, g.heights);
  size_t met = 0;
  for (int k = 0; k < kSolids; ++k) {
    for (uint64_t i = 0; i < 100; ++i) {
      const Solid body = sample_solid(k, i, 0.8);
      const Transform at = random_transform(43, i, 1);
      std::vector<Manifold> a, b;
      collide(mesh, {}, body, at, 0.02, a);
      collide(body, at, field, {}, 0.02, b);
      const auto by_part = [](const Manifold& x, const Manifold& y) { return x.part_a < y.part_a; };
      std::sort(a.begin(), a.end(), by_part);
      for (Manifold& m : b) std::swap(m.part_a, m.part_b), m.normal = -m.normal;
      std::sort(b.begin(), b.end(), by_part);
      ASSERT_EQ(a.size(), b.size());
      met += a.size();
      for (size_t m = 0; m < a.size(); ++m) {
        EXPECT_EQ(a[m].part_a, b[m].part_a);
        EXPECT_LT(norm(a[m].normal - b[m].normal), 1e-9);
        EXPECT_NEAR(a[m].deepest(), b[m].deepest(), 1e-9);
      }
    }
  }
  EXPECT_GT(met, 300u);
}

// Up to its border, across which there is none.
TEST(CollisionSurfaces, HeightFieldHasTheNeighboursOfItsMesh) {
  const Ground g =
      ground(9, [](double x, double z) { return 0.3 * std::sin(3 * x) + 0.2 * std::cos(2 * z + x); });
  const Solid mesh = mesh_solid(g.vertices, g.triangles), field = height_field_solid(9, 9, 0.5, g.heights);
  size_t borders = 0;
  for (uint32_t k = 0; k < mesh.mesh->size(); ++k) {
    const auto sorted = [](std::array<uint32_t, 3> n) {
      std::sort(n.begin(), n.end());
      return n;
    };
    const auto triangle = field.heights->triangle(k);
    ASSERT_TRUE(triangle);
    EXPECT_EQ(sorted(triangle->neighbor), sorted(mesh.mesh->triangle(k).neighbor)) << k;
    borders += static_cast<size_t>(std::ranges::count(triangle->neighbor, MeshTriangle::kBorder));
  }
  EXPECT_EQ(borders, 4 * 8u);
}

/// A box beside a triangle whose neighbour is nearer may not be pushed towards that neighbour: along the
/// directions left to the triangle the two seem to overlap, with edges that pass each other. A heap in a bowl
/// rested on such a contact 2 mm deep, which was lost as soon as the box was 5 mm away, and never slept.
TEST(CollisionSurfaces, TrianglesDoNotTouchWhatIsApart) {
  const Ground g = ground(9, [](double x, double z) { return 0.35 * (x * x + z * z); });
  const Solid field = height_field_solid(9, 9, 0.5, g.heights);
  const Box all{{-2, -1, -2}, {2, 4, 2}};
  constexpr double kMargin = 0.02;
  size_t apart = 0, touching = 0;
  for (uint64_t i = 0; i < 4000; ++i) {
    const Solid box = box_solid({0.3, 0.22, 0.26});
    Transform at = random_transform(47, i, 1.5);
    const Vec3& p = at.position;
    at.position.y = 0.35 * (p.x * p.x + p.z * p.z) + 0.3;
    field.heights->overlapping(all, [&](uint32_t k) {
      const auto triangle = field.heights->triangle(k);
      if (!triangle) return;
      Manifold m;
      collide_local(view(*triangle), view(box), at, kMargin, m);
      if (m.count == 0) return;
      ++touching;
      const CoreDistance d = core_distance(view(*triangle), view(box), at, {0, 1, 0});
      if (d.verdict == CoreDistance::Verdict::overlap || d.distance == 0) return;
      ++apart;
      // The faces of a box may bear where an edge would be nearer by a thousandth of its thickness.
      EXPECT_GE(-m.deepest(), d.distance - 1e-3 * 0.44) << i << " " << k;
    });
  }
  EXPECT_GT(apart, 300u);
  EXPECT_GT(touching, apart);
}

TEST(CollisionSurfaces, BallOverARidgeMayLeanWithinItsCone) {
  // Two slopes meet at x = 0: 45 degrees up, 45 degrees down.
  const Solid roof = mesh_solid({{-1, 0, -1}, {-1, 0, 1}, {0, 1, -1}, {0, 1, 1}, {1, 0, -1}, {1, 0, 1}},
                                {0, 1, 2, 3, 2, 1, 2, 3, 4, 5, 4, 3});
  const Solid ball = sphere_solid(0.5);
  for (const double phi : {-1.0, -0.7, -0.3, 0.0, 0.3, 0.7, 1.0}) {
    const Vec3 n{std::sin(phi), std::cos(phi), 0};
    std::vector<Manifold> all;
    collide(roof, {}, ball, {{}, Vec3{0, 1, 0} + n * 0.49}, 0, all);
    ASSERT_FALSE(all.empty()) << phi;
    // Beyond 45 degrees the slope itself is nearest.
    const double most = 0.7853981633974483, lean = std::clamp(phi, -most, most);
    for (const Manifold& m : all)
      EXPECT_LT(norm(m.normal - Vec3{std::sin(lean), std::cos(lean), 0}), 1e-9) << phi;
  }
}

TEST(CollisionSurfaces, CompoundsAreTheirParts) {
  std::vector<SolidPart> parts;
  for (uint64_t i = 0; i < 9; ++i) {
    const auto u = uniform4(51, 1, i);
    parts.push_back({sample_solid(static_cast<int>(i % kSolids), i, 0.5),
                     {{2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1}, random_quat(52, i)}});
  }
  const Solid compound = compound_solid(parts);
  for (uint64_t i = 0; i < 200; ++i) {
    const Transform at = random_transform(53, i, 2), body_at = random_transform(54, i, 2);
    const Solid body = sample_solid(static_cast<int>(i % kSolids), i, 1);
    std::vector<Manifold> all;
    collide(compound, at, body, body_at, 0.05, all);
    size_t expected = 0;
    for (uint32_t p = 0; p < parts.size(); ++p) {
      Manifold m;
      if (!collide(parts[p].solid, at * transform_of(parts[p].pose), body, body_at, 0.05, m)) continue;
      ++expected;
      const auto found =
          std::find_if(all.begin(), all.end(), [&](const Manifold& x) { return x.part_a == p; });
      ASSERT_NE(found, all.end());
      EXPECT_NEAR(found->deepest(), m.deepest(), 1e-9);
    }
    EXPECT_EQ(all.size(), expected);
    std::vector<Manifold> self;
    collide(compound, at, compound, body_at, 0.05, self);
    for (const Manifold& m : self) EXPECT_LT(m.part_a, parts.size());
  }
}

TEST(CollisionSurfaces, MeshesMeetPlanesWithTheirOutermostVertices) {
  // A block with 9 x 9 points on its lower side, of which the corners carry it.
  std::vector<Vec3> vertices;
  std::vector<uint32_t> triangles;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) vertices.push_back({0.25 * i - 1, 0, 0.25 * j - 1});
  }
  for (uint32_t i = 0; i < 8; ++i) {
    for (uint32_t j = 0; j < 8; ++j) {
      const uint32_t a = 9 * i + j;
      for (const uint32_t k : {a, a + 9, a + 10, a, a + 10, a + 1}) triangles.push_back(k);
    }
  }
  const Solid mesh = mesh_solid(vertices, triangles), plane = plane_solid({0, 1, 0});
  std::vector<Manifold> all;
  ASSERT_EQ(collide(plane, {}, mesh, transform_of(Pose{{0, -0.01, 0}, {}}), 0.05, all), 1u);
  ASSERT_EQ(all[0].count, 4);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(all[0].points[k].separation, -0.01, 1e-15);
    EXPECT_NEAR(std::fabs(all[0].points[k].position.x * all[0].points[k].position.z), 1, 1e-12);
  }
  // From either side, at any position: the deepest vertex is among the points.
  for (uint64_t i = 0; i < 200; ++i) {
    const Transform at = random_transform(61, i, 1), ground_at = random_transform(62, i, 1);
    double lowest = 1e300;
    for (const Vec3& v : vertices)
      lowest = std::min(lowest, dot(ground_at.direction(plane.size), at.point(v) - ground_at.position));
    std::vector<Manifold> one, other;
    collide(plane, ground_at, mesh, at, 0.05, one);
    collide(mesh, at, plane, ground_at, 0.05, other);
    ASSERT_EQ(one.size(), lowest <= 0.05 ? 1u : 0u);
    ASSERT_EQ(other.size(), one.size());
    if (one.empty()) continue;
    EXPECT_NEAR(one[0].deepest(), -lowest, 1e-12);
    EXPECT_LT(norm(one[0].normal + other[0].normal), 1e-15);
  }
}

TEST(CollisionSurfaces, BadSurfacesAreRefused) {
  EXPECT_THROW(mesh_solid({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 3}), Error);
  EXPECT_THROW(mesh_solid({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {0, 1, 2}), Error);
  EXPECT_THROW(mesh_solid({{0, 0, 0}, {1, NAN, 0}, {0, 1, 0}}, {0, 1, 2}), Error);
  EXPECT_THROW(height_field_solid(1, 4, 1, {0, 0, 0, 0}), Error);
  EXPECT_THROW(height_field_solid(2, 2, 0, {0, 0, 0, 0}), Error);
  EXPECT_THROW(compound_solid({}), Error);
  EXPECT_THROW(compound_solid({{plane_solid({0, 1, 0}), {}}}), Error);
}

}  // namespace
}  // namespace truestep
