// Cloth: grids with structural, shear and bending springs (Provot 1995), meshes with springs along edges and
// from corner to opposite corner across them, and free networks.
#include <algorithm>
#include <array>
#include <cstdlib>

#include "engine/systems/mass_spring/network.h"

namespace truestep::mass_spring {

namespace {

constexpr double kFromPositions = -1;  // rest length still to be measured

// Rods along the sides and the diagonals of the cells, lengths u, v and d = sqrt(u^2 + v^2), weighed so that
// their energies per area add up to that of an isotropic plate,
//   D/2 (kuu^2 + kvv^2 + 2 nu kuu kvv + 2 (1 - nu) kuv^2),   nu = 1/3:
// a diagonal's curvature is c^2 kuu + s^2 kvv +- 2 c s kuv with c = u/d, s = v/d, and comparing gives the
// weights
//   1 / (6 c^2 s^2) of a diagonal,   1 - c^2 / (3 s^2) along u,   1 - s^2 / (3 c^2) along v.
void build_plate(const ClothGridShape& shape, double rigidity, Network& out) {
  const int nx = shape.nx, ny = shape.ny;
  const auto index = [nx](int i, int j) { return static_cast<uint32_t>(j * nx + i); };
  const double u2 = norm2(shape.edge_u) / ((nx - 1.0) * (nx - 1.0)),
               v2 = norm2(shape.edge_v) / ((ny - 1.0) * (ny - 1.0)), d2 = u2 + v2;
  const double across = d2 * d2 / (6 * u2 * v2);
  const auto add = [&](int di, int dj, double weight, double length2) {
    for (int j = dj; j + dj < ny; ++j) {
      for (int i = std::abs(di); i + std::abs(di) < nx; ++i) {
        const uint32_t middle = index(i, j);
        out.bends.push_back({{index(i - di, j - dj), middle, index(i + di, j + dj)},
                             weight * rigidity * out.share[middle] / length2});
      }
    }
  };
  add(1, 0, 1 - u2 / (3 * v2), u2);
  add(0, 1, 1 - v2 / (3 * u2), v2);
  add(1, 1, across, d2);
  add(-1, 1, across, d2);
}

void share_triangle(const std::array<uint32_t, 3>& t, Network& out) {
  const double area = 0.5 * norm(cross(out.x[t[1]] - out.x[t[0]], out.x[t[2]] - out.x[t[0]]));
  for (const uint32_t i : t) out.share[i] += area / 3;
}

}  // namespace

void build_cloth_grid(const ClothGridShape& shape, const MassSpringDef& def, Network& out) {
  const int nx = shape.nx, ny = shape.ny;
  const auto index = [nx](int i, int j) { return static_cast<uint32_t>(j * nx + i); };
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
      // The split alternates, so that the cloth has no preferred diagonal.
      if ((i + j) % 2 == 0) {
        out.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
        out.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
      } else {
        out.triangles.push_back({index(i, j), index(i + 1, j), index(i, j + 1)});
        out.triangles.push_back({index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)});
      }
    }
  }
  // Family by family and direction by direction: both ends of consecutive springs are then consecutive.
  const auto add = [&](SpringFamily family, int di, int dj, int skip_i) {
    for (int j = 0; j + dj < ny; ++j) {
      for (int i = skip_i; i + (di > 0 ? di : 0) < nx; ++i) {
        out.springs.push_back({index(i, j), index(i + di, j + dj), family, kFromPositions, 1});
      }
    }
  };
  add(SpringFamily::structural, 1, 0, 0);
  add(SpringFamily::structural, 0, 1, 0);
  if (def.shear_stiffness > 0 && shape.shear != ShearSprings::none) {
    add(SpringFamily::shear, 1, 1, 0);
    if (shape.shear == ShearSprings::both) add(SpringFamily::shear, -1, 1, 1);
  }
  if (def.bending_stiffness > 0) {
    add(SpringFamily::bending, 2, 0, 0);
    add(SpringFamily::bending, 0, 2, 0);
  }
  if (def.flexural_rigidity > 0) build_plate(shape, def.flexural_rigidity, out);
}

void build_mesh(const MeshShape& shape, const MassSpringDef& def, Network& out) {
  out.x = shape.vertices;
  out.share.assign(out.x.size(), 0);
  // An edge as (smaller, larger, opposite): sorted, the triangles of an edge are neighbours.
  std::vector<std::array<uint32_t, 3>> edges;
  for (size_t t = 0; t + 2 < shape.triangles.size(); t += 3) {
    std::array<uint32_t, 3> tri;
    for (size_t k = 0; k < 3; ++k) tri[k] = static_cast<uint32_t>(shape.triangles[t + k]);
    out.triangles.push_back(tri);
    share_triangle(tri, out);
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = tri[k], b = tri[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), tri[(k + 2) % 3]});
    }
  }
  std::sort(edges.begin(), edges.end());
  for (size_t i = 0; i < edges.size(); ++i) {
    const auto& e = edges[i];
    if (i == 0 || edges[i - 1][0] != e[0] || edges[i - 1][1] != e[1]) {
      out.springs.push_back({e[0], e[1], SpringFamily::structural, kFromPositions, 1});
    }
  }
  if (!(def.bending_stiffness > 0)) return;
  for (size_t i = 1; i < edges.size(); ++i) {
    const auto &e = edges[i], &before = edges[i - 1];
    if (e[0] != before[0] || e[1] != before[1] || e[2] == before[2]) continue;
    out.springs.push_back(
        {std::min(e[2], before[2]), std::max(e[2], before[2]), SpringFamily::bending, kFromPositions, 1});
  }
}

void build_free(const FreeShape& shape, Network& out) {
  out.x = shape.points;
  out.v = shape.velocities;
  out.share.assign(out.x.size(), 0);
  for (const FreeSpring& s : shape.springs) {
    out.springs.push_back({static_cast<uint32_t>(s.a), static_cast<uint32_t>(s.b),
                           s.stiffness ? SpringFamily::own : SpringFamily::structural,
                           s.rest_length.value_or(kFromPositions), s.stiffness.value_or(1)});
  }
}

}  // namespace truestep::mass_spring
