// Rays, casts, nearest points and overlap, of single solids and of a broad phase's bodies.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/collision/collision.h"
#include "tests/unit/collision/collision_rig.h"

namespace truestep {
namespace {

using namespace collision_rig;

TEST(Queries, RaysStopOnTheSurface) {
  int hits = 0;
  for (int k = 0; k < kSolids; ++k) {
    for (uint64_t i = 0; i < 400; ++i) {
      const Placed p{sample_solid(k, i, 1), random_transform(60, i, 5)};
      const Vec3 from = p.at.position + random_unit(61, i) * 3.0;
      const Vec3 aim = p.at.position + random_unit(62, i) * (0.6 * bounding_radius(p.solid));
      const Ray ray{from, (aim - from) * 0.7};
      const auto hit = ray_cast(p.solid, p.at, ray, 10);
      // Against 3000 samples: the first one inside lies just behind the hit.
      double first = 100;
      for (int s = 0; s <= 3000 && first > 10; ++s) {
        const double t = 2.5 * s / 3000;
        if (outside(p, ray.origin + ray.direction * t) < -1e-9) first = t;
      }
      if (!hit) {
        EXPECT_GT(first, 10) << k << " " << i;
        continue;
      }
      ++hits;
      EXPECT_LE(hit->t, first) << k << " " << i;
      EXPECT_NEAR(outside(p, ray.origin + ray.direction * hit->t), 0, 1e-12) << k << " " << i;
      EXPECT_LT(dot(hit->normal, ray.direction), 1e-12);
      EXPECT_NEAR(norm(hit->normal), 1, 1e-12);
      EXPECT_FALSE(ray_cast(p.solid, p.at, ray, hit->t * 0.999));
      if (inner_radius(p.solid) > 1e-2) {
        const auto inside = ray_cast(p.solid, p.at, {p.at.point(view(p.solid).center()), ray.direction}, 1);
        ASSERT_TRUE(inside);
        EXPECT_EQ(inside->t, 0);
      }
    }
  }
  EXPECT_GT(hits, 1000);
}

TEST(Queries, RaysOnMeshesAndHeightFieldsAgree) {
  std::vector<double> heights;
  std::vector<Vec3> vertices;
  std::vector<uint32_t> triangles;
  for (uint32_t j = 0; j < 12; ++j) {
    for (uint32_t i = 0; i < 12; ++i) {
      heights.push_back(uniform4(7, 7, heights.size())[0]);
      vertices.push_back({(i - 5.5) * 0.5, heights.back(), (j - 5.5) * 0.5});
      if (i == 11 || j == 11) continue;
      const uint32_t v = j * 12 + i;
      for (const uint32_t k : {v, v + 12, v + 1, v + 13, v + 1, v + 12}) triangles.push_back(k);
    }
  }
  const Solid field = height_field_solid(12, 12, 0.5, heights), mesh = mesh_solid(vertices, triangles);
  int hits = 0;
  for (uint64_t i = 0; i < 2000; ++i) {
    const Transform at = random_transform(63, i, 2);
    const Ray ray{at.point(random_unit(64, i) * 4.0), random_unit(65, i) * 1.3};
    const auto a = ray_cast(field, at, ray, 8), b = ray_cast(mesh, at, ray, 8);
    ASSERT_EQ(a.has_value(), b.has_value()) << i;
    if (!a) continue;
    ++hits;
    EXPECT_NEAR(a->t, b->t, 1e-12);
  }
  EXPECT_GT(hits, 150);
}

TEST(Queries, NearestPointsAreThatFarApart) {
  for (int a = 0; a < kSolids; ++a) {
    for (int b = 0; b < kSolids; ++b) {
      for (uint64_t i = 0; i < 20; ++i) {
        const Placed p{sample_solid(a, i, 1), random_transform(66, i, 1)},
            q{sample_solid(b, i, 1), random_transform(67, i, 2)};
        const auto d = nearest_points(p.solid, p.at, q.solid, q.at, 100);
        ASSERT_TRUE(d);
        EXPECT_LE(outside(p, d->point_a), 2e-3);
        EXPECT_LE(outside(q, d->point_b), 2e-3);
        EXPECT_EQ(overlap(p.solid, p.at, q.solid, q.at), d->distance <= 0);
        if (d->distance <= 0) continue;
        EXPECT_NEAR(norm(d->point_b - d->point_a), d->distance, 1e-9);
        EXPECT_NEAR(static_cast<double>(separation_along(p, q, {d->normal.x, d->normal.y, d->normal.z})),
                    d->distance, 1e-6);
        EXPECT_FALSE(nearest_points(p.solid, p.at, q.solid, q.at, d->distance * 0.99));
      }
    }
  }
}

TEST(Queries, NearestPointOfEverySolid) {
  for (int k = 0; k < kSolids; ++k) {
    for (uint64_t i = 0; i < 200; ++i) {
      const Placed p{sample_solid(k, i, 1), random_transform(68, i, 1)};
      const Vec3 x = p.at.position + random_unit(69, i) * (0.02 * static_cast<double>(i));
      const auto n = nearest_point(p.solid, p.at, x, 100);
      ASSERT_TRUE(n);
      EXPECT_NEAR(outside(p, n->point), 0, 1e-9) << k << " " << i;
      EXPECT_NEAR(norm(n->point - x), std::fabs(n->distance), 1e-9) << k << " " << i;
      EXPECT_EQ(n->distance < 0, outside(p, x) < 0) << k << " " << i;
    }
  }
}

TEST(Queries, WorldQueriesAreLoopsOverAllBodies) {
  std::vector<Solid> solids;
  std::vector<Pose> poses;
  std::vector<Box> boxes;
  for (uint64_t i = 0; i < 300; ++i) {
    const auto u = uniform4(70, 1, i);
    solids.push_back(sample_solid(static_cast<int>(i % kSolids), i, 0.6));
    poses.push_back({Vec3{u[0], u[1], u[2]} * 10.0, random_quat(71, i)});
    boxes.push_back(bounds(solids.back(), transform_of(poses.back())));
  }
  solids.push_back(plane_solid({0, 1, 0}));
  poses.push_back({});
  boxes.push_back(bounds(solids.back(), {}));
  BroadPhase broad;
  broad.update(boxes, std::vector<Mobility>(boxes.size(), Mobility::moving), 0.1);
  const auto body = [&](uint32_t i) { return PlacedSolid{&solids[i], poses[i]}; };
  int rays = 0, casts = 0;
  for (uint64_t i = 0; i < 200; ++i) {
    const auto u = uniform4(72, 1, i);
    const Vec3 from = Vec3{u[0], u[1], u[2]} * 10.0, way = random_unit(73, i) * 6.0;
    const auto hit = ray_cast(broad, body, {from, way}, 1);
    std::optional<BodyHit> expected;
    for (uint32_t k = 0; k < solids.size(); ++k) {
      const auto h = ray_cast(solids[k], transform_of(poses[k]), {from, way}, 1);
      if (h && (!expected || h->t < expected->hit.t)) expected = {k, *h};
    }
    ASSERT_EQ(hit.has_value(), expected.has_value());
    if (hit) {
      ++rays;
      EXPECT_EQ(hit->body, expected->body);
      EXPECT_EQ(hit->hit.t, expected->hit.t);
    }

    const Solid probe = sample_solid(static_cast<int>(i % kSolids), i, 0.4);
    const Pose at{from, random_quat(74, i)};
    std::vector<uint32_t> found, all;
    overlapping_bodies(broad, body, probe, transform_of(at), found);
    for (uint32_t k = 0; k < solids.size(); ++k) {
      if (overlap(probe, transform_of(at), solids[k], transform_of(poses[k]))) all.push_back(k);
    }
    EXPECT_EQ(found, all);

    const auto cast = shape_cast(broad, body, probe, at, way, 1e-4);
    std::optional<BodyImpact> first;
    for (uint32_t k = 0; k < solids.size(); ++k) {
      const auto h = shape_cast(probe, at, way, solids[k], poses[k], 1e-4);
      if (h && (!first || h->t < first->impact.t)) first = {k, *h};
    }
    ASSERT_EQ(cast.has_value(), first.has_value());
    if (cast) {
      ++casts;
      EXPECT_EQ(cast->body, first->body);
      EXPECT_EQ(cast->impact.t, first->impact.t);
    }
  }
  EXPECT_GT(rays, 60);
  EXPECT_GT(casts, 100);
}

}  // namespace
}  // namespace truestep
