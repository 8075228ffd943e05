#include "engine/geometry/height_field.h"

#include <cmath>

#include "engine/base/errors.h"

namespace truestep {

HeightField::HeightField(size_t nx, size_t nz, double spacing, std::vector<double> heights)
    : nx_(nx), nz_(nz), spacing_(spacing), heights_(std::move(heights)), bounds_(Box::nothing()) {
  if (nx < 2 || nz < 2 || nx > (1u << 15) || nz > (1u << 15) || heights_.size() != nx * nz) {
    throw Error("bad_solid", "a height field needs nx x nz heights, both at least 2");
  }
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw Error("bad_solid", "the spacing of a height field must be positive");
  for (size_t j = 0; j < nz; ++j) {
    for (size_t i = 0; i < nx; ++i) {
      const double h = heights_[j * nx + i];
      if (std::isinf(h))
        throw Error("bad_solid", "the heights of a height field must be finite, or NaN for holes");
      if (!std::isnan(h)) bounds_.cover(vertex(i, j));
    }
  }
}

Vec3 HeightField::vertex(size_t i, size_t j) const {
  return {(static_cast<double>(i) - 0.5 * static_cast<double>(nx_ - 1)) * spacing_, heights_[j * nx_ + i],
          (static_cast<double>(j) - 0.5 * static_cast<double>(nz_ - 1)) * spacing_};
}

std::optional<std::array<Vec3, 3>> HeightField::corners(uint32_t index) const {
  const size_t c = index / 2, i = c % (nx_ - 1), j = c / (nx_ - 1);
  const std::array<Vec3, 3> t =
      index % 2 == 0 ? std::array<Vec3, 3>{vertex(i, j), vertex(i, j + 1), vertex(i + 1, j)}
                     : std::array<Vec3, 3>{vertex(i + 1, j + 1), vertex(i + 1, j), vertex(i, j + 1)};
  if (std::isnan(t[0].y + t[1].y + t[2].y)) return std::nullopt;
  return t;
}

std::optional<MeshTriangle> HeightField::triangle(uint32_t index) const {
  const auto own = corners(index);
  if (!own) return std::nullopt;
  MeshTriangle t;
  t.corner = *own;
  t.complete();
  // Across edge k -> k + 1 lies the triangle whose third corner is point-symmetric about the edge's middle.
  const size_t c = index / 2, i = c % (nx_ - 1), j = c / (nx_ - 1), row = nx_ - 1;
  struct Across {
    bool there;
    size_t cell;
  };
  const Across even[3] = {{i > 0, c - 1}, {true, c}, {j > 0, c - row}};
  const Across odd[3] = {{i + 2 < nx_, c + 1}, {true, c}, {j + 2 < nz_, c + row}};
  for (size_t k = 0; k < 3; ++k) {
    const Across& a = index % 2 == 0 ? even[k] : odd[k];
    if (!a.there) continue;
    const auto other = static_cast<uint32_t>(2 * a.cell + (index + 1) % 2);
    const auto theirs = corners(other);
    if (!theirs) continue;
    // Shared edges have the same number on both sides, so the third corner is number k + 2 there, too.
    t.set_neighbor(k, other, (*theirs)[(k + 2) % 3]);
  }
  return t;
}

}  // namespace truestep
