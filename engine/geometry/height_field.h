// Ground as heights over a square grid in the x-z plane, centred on the origin:
//   vertex (i, j) = ((i - (nx - 1) / 2) s, h[j nx + i], (j - (nz - 1) / 2) s).
// Every cell is two triangles, cut from (i, j + 1) to (i + 1, j); triangle 2 (j (nx - 1) + i) is the one at
// (i, j). Triangles are made on the fly; only the heights are stored. A height that is NaN is a hole.
#pragma once
#include <optional>
#include <vector>

#include "engine/geometry/triangle_mesh.h"

namespace truestep {

class HeightField {
 public:
  /// Error "bad_solid" when the heights are too few, too many or not nx x nz, when one is infinite, or when
  /// the spacing (m) is not positive and finite.
  HeightField(size_t nx, size_t nz, double spacing, std::vector<double> heights);

  size_t triangle_count() const { return 2 * (nx_ - 1) * (nz_ - 1); }
  const Box& bounds() const { return bounds_; }
  size_t columns() const { return nx_; }  ///< vertices along x
  size_t lines() const { return nz_; }    ///< vertices along z
  Vec3 vertex(size_t i, size_t j) const;
  /// Corners only; empty in a hole.
  std::optional<std::array<Vec3, 3>> corners(uint32_t index) const;
  /// With neighbours.
  std::optional<MeshTriangle> triangle(uint32_t index) const;

  /// visit(index) for every triangle, holes included, whose cell lies under or over the box and that may
  /// reach its heights.
  template <class Visit>
  void overlapping(const Box& b, Visit&& visit) const {
    if (!bounds_.overlaps(b)) return;
    const size_t i0 = cell(b.low.x, nx_), i1 = cell(b.high.x, nx_);
    const size_t j0 = cell(b.low.z, nz_), j1 = cell(b.high.z, nz_);
    for (size_t j = j0; j <= j1; ++j) {
      for (size_t i = i0; i <= i1; ++i) {
        const double* h = heights_.data() + j * nx_ + i;
        const double h0 = h[0], h1 = h[1], h2 = h[nx_], h3 = h[nx_ + 1];
        if ((h0 > b.high.y && h1 > b.high.y && h2 > b.high.y && h3 > b.high.y) ||
            (h0 < b.low.y && h1 < b.low.y && h2 < b.low.y && h3 < b.low.y)) {
          continue;
        }
        const auto index = static_cast<uint32_t>(2 * (j * (nx_ - 1) + i));
        visit(index);
        visit(index + 1);
      }
    }
  }

 private:
  size_t cell(double x, size_t n) const {
    const double c = x / spacing_ + 0.5 * static_cast<double>(n - 1);
    if (!(c > 0)) return 0;
    return c < static_cast<double>(n - 2) ? static_cast<size_t>(c) : n - 2;
  }
  size_t nx_, nz_;
  double spacing_;
  std::vector<double> heights_;
  Box bounds_;
};

}  // namespace truestep
