#include "engine/geometry/make/soft_block.h"

#include <algorithm>

namespace truestep {

namespace {

std::array<uint32_t, 3> sorted(std::array<uint32_t, 3> t) {
  std::sort(t.begin(), t.end());
  return t;
}

// Faces that belong to one tetrahedron only.
std::vector<std::array<uint32_t, 3>> surface(const std::vector<std::array<uint32_t, 4>>& tetrahedra) {
  std::vector<std::array<uint32_t, 3>> faces;
  for (const auto& t : tetrahedra) {
    // Outward for a positive volume.
    faces.push_back({t[0], t[2], t[1]}), faces.push_back({t[0], t[1], t[3]});
    faces.push_back({t[0], t[3], t[2]}), faces.push_back({t[1], t[2], t[3]});
  }
  std::stable_sort(faces.begin(), faces.end(), [](auto& a, auto& b) { return sorted(a) < sorted(b); });
  std::vector<std::array<uint32_t, 3>> out;
  for (size_t k = 0; k < faces.size(); ++k) {
    const bool twin = (k > 0 && sorted(faces[k - 1]) == sorted(faces[k])) ||
                      (k + 1 < faces.size() && sorted(faces[k + 1]) == sorted(faces[k]));
    if (!twin) out.push_back(faces[k]);
  }
  return out;
}

}  // namespace

SoftBlock make_soft_block(const SoftBlockShape& shape) {
  const int nx = shape.cells_x + 1, ny = shape.cells_y + 1;
  const auto index = [&](int i, int j, int k) { return static_cast<uint32_t>((k * ny + j) * nx + i); };
  SoftBlock out;
  for (int k = 0; k <= shape.cells_z; ++k) {
    for (int j = 0; j <= shape.cells_y; ++j) {
      for (int i = 0; i <= shape.cells_x; ++i) {
        out.x.push_back(shape.origin + Vec3{shape.size.x * i / shape.cells_x,
                                            shape.size.y * j / shape.cells_y,
                                            shape.size.z * k / shape.cells_z});
      }
    }
  }
  // Corners of a cell are numbered by the bits x + 2 y + 4 z. The inner tetrahedron has the corners with an
  // even number of bits, or those with an odd one; each of the other four takes one of the remaining corners.
  constexpr int kEven[5][4] = {{0, 3, 6, 5}, {1, 3, 0, 5}, {2, 0, 3, 6}, {4, 6, 5, 0}, {7, 5, 6, 3}};
  constexpr int kOdd[5][4] = {{1, 2, 4, 7}, {0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}};
  out.share.assign(out.x.size(), 0);
  for (int k = 0; k < shape.cells_z; ++k) {
    for (int j = 0; j < shape.cells_y; ++j) {
      for (int i = 0; i < shape.cells_x; ++i) {
        for (const auto& corners : (i + j + k) % 2 == 0 ? kEven : kOdd) {
          std::array<uint32_t, 4> t;
          for (size_t c = 0; c < 4; ++c) {
            t[c] = index(i + (corners[c] & 1), j + ((corners[c] >> 1) & 1), k + ((corners[c] >> 2) & 1));
          }
          const Vec3 &a = out.x[t[0]], &b = out.x[t[1]], &c = out.x[t[2]], &d = out.x[t[3]];
          double volume = dot(b - a, cross(c - a, d - a)) / 6;
          if (volume < 0) std::swap(t[2], t[3]), volume = -volume;
          for (const uint32_t p : t) out.share[p] += volume / 4;
          out.tetrahedra.push_back(t);
        }
      }
    }
  }
  for (const auto& t : out.tetrahedra) {
    for (size_t a = 0; a < 4; ++a) {
      for (size_t b = a + 1; b < 4; ++b) out.edges.push_back({std::min(t[a], t[b]), std::max(t[a], t[b])});
    }
  }
  std::sort(out.edges.begin(), out.edges.end());
  out.edges.erase(std::unique(out.edges.begin(), out.edges.end()), out.edges.end());
  out.triangles = surface(out.tetrahedra);
  return out;
}

}  // namespace truestep
