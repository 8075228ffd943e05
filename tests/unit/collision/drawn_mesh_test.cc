// Drawn meshes: volume and area of their solid, outward normals, flat faces that stay flat.
#include "engine/collision/drawn_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/collision/flat/outline_mesh.h"
#include "engine/geometry/mass_properties.h"
#include "tests/unit/collision/collision_rig.h"

namespace truestep {
namespace {

Vec3 at(const std::vector<float>& v, size_t i) {
  return {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
}

/// Divergence theorem: V = 1/6 sum a . (b x c); positive when triangles run anticlockwise seen from outside.
double volume(const DrawnMesh& m) {
  double v = 0;
  for (size_t t = 0; t + 2 < m.triangles.size(); t += 3) {
    const Vec3 a = at(m.positions, m.triangles[t]), b = at(m.positions, m.triangles[t + 1]),
               c = at(m.positions, m.triangles[t + 2]);
    v += dot(a, cross(b, c)) / 6;
  }
  return v;
}

/// Area of the triangles whose normal has a positive part along `axis`, seen along it.
double shadow(const DrawnMesh& m, const Vec3& axis) {
  double area = 0;
  for (size_t t = 0; t + 2 < m.triangles.size(); t += 3) {
    const Vec3 a = at(m.positions, m.triangles[t]), b = at(m.positions, m.triangles[t + 1]),
               c = at(m.positions, m.triangles[t + 2]);
    area += std::max(0.0, 0.5 * dot(axis, cross(b - a, c - a)));
  }
  return area;
}

/// Smallest cosine between a corner's normal and its triangle's.
double least_agreement(const DrawnMesh& m) {
  double least = 1;
  for (size_t t = 0; t + 2 < m.triangles.size(); t += 3) {
    const Vec3 a = at(m.positions, m.triangles[t]), b = at(m.positions, m.triangles[t + 1]),
               c = at(m.positions, m.triangles[t + 2]);
    const Vec3 n = normalized(cross(b - a, c - a));
    for (size_t k = 0; k < 3; ++k) least = std::min(least, dot(n, at(m.normals, m.triangles[t + k])));
  }
  return least;
}

std::vector<Vec3> cube(double h) {
  std::vector<Vec3> p;
  for (int k = 0; k < 8; ++k) p.push_back({k & 1 ? h : -h, k & 2 ? h : -h, k & 4 ? h : -h});
  return p;
}

TEST(DrawnMesh, ACubesFacesAreFlat) {
  const auto mesh = drawn_mesh(hull_solid(cube(0.5)));
  EXPECT_NEAR(volume(*mesh), 1, 1e-6);         // float positions
  EXPECT_EQ(mesh->positions.size(), 3 * 24u);  // every corner with three normals
  EXPECT_NEAR(least_agreement(*mesh), 1, 1e-6);
}

TEST(DrawnMesh, HullsHaveTheirVolumeAndLookOutwards) {
  for (uint64_t i = 0; i < 20; ++i) {
    std::vector<Vec3> points;
    for (uint64_t k = 0; k < 40; ++k) points.push_back(collision_rig::random_unit(i, k));
    const Solid solid = hull_solid(points);
    const auto mesh = drawn_mesh(solid);
    const double v = mass_properties(solid, 1).mass;
    EXPECT_NEAR(volume(*mesh), v, 1e-5 * v) << i;  // float positions
    EXPECT_GT(least_agreement(*mesh), 0.7) << i;   // smoothed, by faces at most 37 degrees away
    // Control: a mesh turned inside out has minus the volume.
    DrawnMesh inside_out = *mesh;
    std::reverse(inside_out.triangles.begin(), inside_out.triangles.end());
    EXPECT_LT(volume(inside_out), 0);
  }
}

TEST(DrawnMesh, TrianglesStayWhatTheyAre) {
  const std::vector<Vec3> p = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto mesh = drawn_mesh(mesh_solid(p, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}));
  EXPECT_NEAR(volume(*mesh), 1.0 / 6, 1e-7);
}

TEST(DrawnMesh, AHeightFieldCoversItsGridWithoutItsHoles) {
  std::vector<double> h(5 * 4, 0.3);
  EXPECT_NEAR(shadow(*drawn_mesh(height_field_solid(5, 4, 0.5, h)), {0, 1, 0}), 4 * 3 * 0.25, 1e-6);
  h[0] = std::nan("");  // the corner takes one triangle with it
  EXPECT_NEAR(shadow(*drawn_mesh(height_field_solid(5, 4, 0.5, h)), {0, 1, 0}), 4 * 3 * 0.25 - 0.125, 1e-6);
  // A wide one is thinned, not cropped.
  EXPECT_NEAR(shadow(*drawn_mesh(height_field_solid(1500, 2, 1, std::vector<double>(3000, 0))), {0, 1, 0}),
              1499, 1e-2);
}

TEST(DrawnMesh, WhatKindAndSizeTellNeedsNoMesh) {
  EXPECT_EQ(drawn_mesh(sphere_solid(1)), nullptr);
  EXPECT_EQ(drawn_shape(cylinder_solid(1, 2), {}).kind, DrawnShape::Kind::cylinder);
  EXPECT_EQ(drawn_shape(hull_solid(cube(1)), {}).kind, DrawnShape::Kind::mesh);
}

TEST(DrawnMesh, OutlinesArePrismsOfTheirArea) {
  const flat::Vec2 triangle[] = {{0, 0}, {2, 0}, {0.5, 1.5}};
  for (const flat::Outline& s : {flat::box(0.5, 0.3, {0.2, -0.1}, {0.6, 0.8}), flat::polygon(triangle)}) {
    const auto mesh = flat::outline_mesh(s, 0.4);
    const double area = flat::area_of(s).area;
    EXPECT_NEAR(shadow(*mesh, {0, 0, 1}), area, 1e-6);
    EXPECT_NEAR(shadow(*mesh, {0, 0, -1}), area, 1e-6);
    EXPECT_LT(volume(*mesh), 0.4 * area);  // the rim is bevelled
    EXPECT_GT(volume(*mesh), 0.9 * 0.4 * area);
    EXPECT_GT(least_agreement(*mesh), 0.7);
  }
}

TEST(DrawnMesh, RoundOutlinesAreChordsOfTheirArea) {
  // A chord of 0.3 rad cuts 0.3^2 / 6 = 1.5 % off a disk's sector.
  for (const flat::Outline& s : {flat::capsule({-1, 0}, {1, 0.2}, 0.5), flat::box(0.5, 0.3, {}, {}, 0.2)}) {
    const double area = flat::area_of(s).area, drawn = shadow(*flat::outline_mesh(s, 0.4), {0, 0, 1});
    EXPECT_LT(drawn, area);
    EXPECT_GT(drawn, 0.985 * area);
  }
  // A disk lacks its notch: a triangle of 0.14 rad from the rim to 0.6 of the radius.
  const double disk = shadow(*flat::outline_mesh(flat::circle(1), 0.4), {0, 0, 1});
  EXPECT_NEAR(disk, M_PI - 0.5 * 0.14 * 0.4, 0.02);
  // A link is a strip a quarter as thick as it is deep.
  const flat::Vec2 line[] = {{0, 0}, {2, 0}};
  EXPECT_NEAR(volume(*flat::outline_mesh(flat::chain(line, flat::Ends::open)[0], 0.4)), 2 * 0.1 * 0.4, 1e-6);
}

}  // namespace
}  // namespace truestep
