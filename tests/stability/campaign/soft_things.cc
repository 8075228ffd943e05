// Soft things of springs, of constraints and of finite elements, for the families that join or drape them.
#include "tests/stability/campaign/soft_things.h"

#include <vector>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

json::object grid(double side, int n) {
  return {{"origin", vec(-0.5 * side, 0, -0.5 * side)},
          {"edge_u", vec(side, 0, 0)},
          {"edge_v", vec(0, 0, side)},
          {"nx", n},
          {"ny", n}};
}

/// A cloth of xpbd or springs.
SoftThing cloth_of(Dice& d, const char* type, double stiffest) {
  const double side = d.between(0.6, 1.6), point = d.spread(1e-4, 0.3), k = d.spread(100, stiffest);
  const double thick = d.between(0.01, 0.04);
  const int n = d.whole(4, 8);
  json::object s{{"type", type},
                 {"cloth_grid", grid(side, n)},
                 {"mass", point},
                 {"stiffness", k},
                 {"shear_stiffness", k * d.between(0, 0.5)},
                 {"thickness", thick}};
  if (d.chance(0.7)) s["pinned"] = json::array{d.of({"corners", "corners", "border"})};
  return {std::move(s),
          point * n * n,
          side / (n - 1),
          0.5 * thick,
          -0.5 * thick,
          {n * n / 2, n * n / 2 + 1, n / 2},
          {}};
}

SoftThing rope_of(Dice& d, const char* type, double stiffest) {
  const double half = d.between(0.3, 1), point = d.spread(1e-4, 1), thick = d.between(0.01, 0.04);
  const int links = d.whole(3, 20);
  json::object s{{"type", type},
                 {"rope", json::object{{"from", vec(-half, 0)}, {"to", vec(half, 0)}, {"links", links}}},
                 {"mass", point},
                 {"stiffness", d.spread(100, stiffest)},
                 {"thickness", thick}};
  if (d.chance(0.7)) s["pinned"] = json::array{"first"};
  return {std::move(s), point * (links + 1),           2 * half / links, 0.5 * thick,
          -0.5 * thick, {links, links - 1, links / 2}, {half, 0, 0}};
}

/// A block of tetrahedra (xpbd) or bricks (fem).
SoftThing block_of(Dice& d, const char* type, double stiffer) {
  const double side = d.between(0.3, 0.8), high = side * d.between(0.3, 1), density = d.spread(5, 3000);
  const int n = d.whole(1, 4), up = d.whole(1, 2);
  json::object s{{"type", type},
                 {"block", json::object{{"origin", vec(-0.5 * side, -high, -0.5 * side)},
                                        {"size", vec(side, high, side)},
                                        {"cells_x", n},
                                        {"cells_y", up},
                                        {"cells_z", n}}},
                 {"density", density},
                 {"youngs_modulus", d.spread(1e3, 1e7 * stiffer)},
                 {"poisson_ratio", d.between(0, 0.45)}};
  if (d.chance(0.7)) s["pinned"] = json::array{std::string(type) == "fem" ? "y0" : "bottom"};
  return {std::move(s), density * side * side * high, side / n, 0.01, -high - 0.01,
          {-1, -2, -3}, {0.5 * side, 0, 0.5 * side}};
}

/// A membrane or a shell of finite elements.
SoftThing sheet_of(Dice& d, double stiffer) {
  const double half = d.between(0.3, 0.8), thick = d.spread(0.5e-3, 0.02), density = d.spread(50, 3000);
  const int n = d.whole(2, 6), row = n + 1;
  const bool shell = d.chance(0.5);
  json::array vertices, cells;
  for (int j = 0; j < row; ++j) {
    for (int i = 0; i < row; ++i)
      vertices.push_back(vec(half * (2.0 * i / n - 1), 0, half * (2.0 * j / n - 1)));
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int at = j * row + i;
      for (const int corner : shell ? std::vector{at, at + row, at + row + 1, at, at + row + 1, at + 1}
                                    : std::vector{at, at + row, at + row + 1, at + 1})
        cells.push_back(corner);
    }
  }
  json::object s{
      {"type", "fem"},
      {"plane", shell ? "shell" : "membrane"},
      {"plane_thickness", thick},
      {"mesh",
       json::object{{"vertices", vertices}, {"cells", cells}, {"form", shell ? "triangles" : "quadrangles"}}},
      {"density", density},
      {"youngs_modulus", d.spread(1e4, 1e8 * stiffer)},
      {"poisson_ratio", d.between(0, 0.45)}};
  if (d.chance(0.7)) s["pinned"] = json::array{"border"};
  if (shell) s["element"] = "tri6";
  const int middle = row * row / 2;
  return {std::move(s),
          density * thick * 4 * half * half,
          2 * half / n,
          0.01,
          -0.01,
          {middle, middle - 1, middle - 2},
          {}};
}

/// A free net of points and springs between neighbours and some others.
SoftThing net_of(Dice& d, double stiffer) {
  json::array points, springs, masses;
  const int n = d.whole(4, 12);
  double mass = 0;
  for (int i = 0; i < n; ++i) {
    points.push_back(vec(Vec3{0, -0.6, 0} + d.in_cube(0.5)));
    masses.push_back(d.spread(1e-3, 1)), mass += masses.back().to_number<double>();
    for (int k = 0; k < 2 && i > k; ++k)
      springs.push_back(json::object{{"a", k == 0 ? i - 1 : d.whole(0, i - 2)}, {"b", i}});
  }
  json::object s{{"type", "mass_spring"},
                 {"free", json::object{{"points", points}, {"masses", masses}, {"springs", springs}}},
                 {"stiffness", d.spread(10, 1e6 * stiffer)},
                 {"thickness", 0.03}};
  if (d.chance(0.5)) s["pins"] = json::array{0};
  return {std::move(s), mass, 0.5, 0, -1.12, {n - 1, n - 2, n / 2}, {0, 0, 0}};
}

}  // namespace

SoftThing soft(Dice& d, Soft kind, double stiffer) {
  switch (kind) {
    case Soft::xpbd_cloth:
      return cloth_of(d, "xpbd", 1e6 * stiffer);
    case Soft::xpbd_rope:
      return rope_of(d, "xpbd", 1e7 * stiffer);
    case Soft::xpbd_block:
      return block_of(d, "xpbd", stiffer);
    case Soft::fem_block:
      return block_of(d, "fem", stiffer);
    case Soft::fem_sheet:
      return sheet_of(d, stiffer);
    case Soft::spring_cloth:
      return cloth_of(d, "mass_spring", 1e5 * stiffer);
    case Soft::spring_rope:
      return rope_of(d, "mass_spring", 1e6 * stiffer);
    case Soft::spring_net:
      return net_of(d, stiffer);
  }
  return {};
}

}  // namespace truestep::campaign
