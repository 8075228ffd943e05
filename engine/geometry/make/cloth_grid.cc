#include "engine/geometry/make/cloth_grid.h"

#include <cmath>
#include <cstdlib>

namespace truestep {

ClothGrid make_cloth_grid(const ClothGridShape& shape) {
  const int nx = shape.nx, ny = shape.ny;
  const auto index = [nx](int i, int j) { return static_cast<uint32_t>(j * nx + i); };
  ClothGrid out;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      out.x.push_back(shape.origin + (static_cast<double>(i) / (nx - 1)) * shape.edge_u +
                      (static_cast<double>(j) / (ny - 1)) * shape.edge_v);
    }
  }
  // Every square gives a quarter of its area to each corner.
  out.share.assign(out.x.size(), 0);
  const double quarter = 0.25 * norm(cross(shape.edge_u, shape.edge_v)) / ((nx - 1.0) * (ny - 1.0));
  for (int j = 0; j + 1 < ny; ++j) {
    for (int i = 0; i + 1 < nx; ++i) {
      for (const uint32_t p : {index(i, j), index(i + 1, j), index(i, j + 1), index(i + 1, j + 1)}) {
        out.share[p] += quarter;
      }
      if ((i + j) % 2 == 0) {
        out.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
        out.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
      } else {
        out.triangles.push_back({index(i, j), index(i + 1, j), index(i, j + 1)});
        out.triangles.push_back({index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)});
      }
    }
  }
  return out;
}

std::vector<std::array<uint32_t, 2>> grid_pairs(const ClothGridShape& shape, int di, int dj) {
  const int nx = shape.nx, first = di < 0 ? -di : 0, past = di > 0 ? di : 0;
  std::vector<std::array<uint32_t, 2>> out;
  for (int j = 0; j + dj < shape.ny; ++j) {
    for (int i = first; i + past < nx; ++i) {
      out.push_back({static_cast<uint32_t>(j * nx + i), static_cast<uint32_t>((j + dj) * nx + i + di)});
    }
  }
  return out;
}

std::vector<uint32_t> named_grid_points(const ClothGridShape& shape, std::string_view name) {
  const auto nx = static_cast<uint32_t>(shape.nx), ny = static_cast<uint32_t>(shape.ny);
  std::vector<uint32_t> out;
  for (uint32_t j = 0; j < ny; ++j) {
    for (uint32_t i = 0; i < nx; ++i) {
      const bool u0 = i == 0, u1 = i + 1 == nx, v0 = j == 0, v1 = j + 1 == ny;
      const bool hit = (name == "corners" && (u0 || u1) && (v0 || v1)) || (name == "corner_00" && u0 && v0) ||
                       (name == "corner_10" && u1 && v0) || (name == "corner_01" && u0 && v1) ||
                       (name == "corner_11" && u1 && v1) || (name == "edge_u0" && u0) ||
                       (name == "edge_u1" && u1) || (name == "edge_v0" && v0) || (name == "edge_v1" && v1) ||
                       (name == "border" && (u0 || u1 || v0 || v1));
      if (hit) out.push_back(j * nx + i);
    }
  }
  return out;
}

PlateWeights plate_weights(const ClothGridShape& shape) {
  const int nx = shape.nx, ny = shape.ny;
  const double u2 = norm2(shape.edge_u) / ((nx - 1.0) * (nx - 1.0)),
               v2 = norm2(shape.edge_v) / ((ny - 1.0) * (ny - 1.0)), d2 = u2 + v2;
  return {1 - u2 / (3 * v2), 1 - v2 / (3 * u2), d2 * d2 / (6 * u2 * v2), u2, v2};
}

const char* plate_fault(const ClothGridShape& g) {
  if (std::abs(dot(g.edge_u, g.edge_v)) > 1e-6 * norm(g.edge_u) * norm(g.edge_v)) {
    return "needs edge_u and edge_v at right angles";
  }
  const double u = norm(g.edge_u) / (g.nx - 1), v = norm(g.edge_v) / (g.ny - 1);
  if (u * u > 3 * v * v || v * v > 3 * u * u) {
    return "needs cells with one side at most 1.7 times the other";
  }
  return nullptr;
}

std::vector<PlateRod> plate_rods(const ClothGridShape& shape) {
  const int nx = shape.nx, ny = shape.ny;
  const auto index = [nx](int i, int j) { return static_cast<uint32_t>(j * nx + i); };
  const PlateWeights w = plate_weights(shape);
  std::vector<PlateRod> out;
  const auto add = [&](int di, int dj, double weight, double length2) {
    for (int j = dj; j + dj < ny; ++j) {
      for (int i = std::abs(di); i + std::abs(di) < nx; ++i) {
        out.push_back({{index(i - di, j - dj), index(i, j), index(i + di, j + dj)}, weight, length2});
      }
    }
  };
  add(1, 0, w.u, w.u2);
  add(0, 1, w.v, w.v2);
  add(1, 1, w.diagonal, w.u2 + w.v2);
  add(-1, 1, w.diagonal, w.u2 + w.v2);
  return out;
}

}  // namespace truestep
