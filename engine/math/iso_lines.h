// Level lines of values on a plane lattice: marching squares (Lorensen and Cline 1987 in the plane),
// crossings by linear interpolation along the edges, saddles decided by the mean of the four corners (Nielson
// and Hamann 1991).
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace truestep {

/// A piece of a level line; lattice coordinates, nodes at whole numbers.
using IsoSegment = std::array<std::array<double, 2>, 2>;

/// Of nx x ny values, x fastest. Cells with a corner that is not finite have none.
inline void append_iso_lines(std::span<const float> values, size_t nx, size_t ny, double level,
                             std::vector<IsoSegment>& out) {
  for (size_t y = 0; y + 1 < ny; ++y) {
    for (size_t x = 0; x + 1 < nx; ++x) {
      // Corners anticlockwise from the lower left.
      const double v[4] = {values[x + nx * y] - level, values[x + 1 + nx * y] - level,
                           values[x + 1 + nx * (y + 1)] - level, values[x + nx * (y + 1)] - level};
      if (!std::isfinite(v[0] + v[1] + v[2] + v[3])) continue;
      const double px[4] = {0, 1, 1, 0}, py[4] = {0, 0, 1, 1};
      std::array<std::array<double, 2>, 4> crossing;
      size_t edges[4], n = 0;
      for (size_t e = 0; e < 4; ++e) {
        const double a = v[e], b = v[(e + 1) % 4];
        if ((a < 0) == (b < 0)) continue;
        const double t = a / (a - b);
        crossing[e] = {static_cast<double>(x) + px[e] + t * (px[(e + 1) % 4] - px[e]),
                       static_cast<double>(y) + py[e] + t * (py[(e + 1) % 4] - py[e])};
        edges[n++] = e;
      }
      if (n == 2) out.push_back({crossing[edges[0]], crossing[edges[1]]});
      if (n != 4) continue;
      // The middle has the sign of two opposite corners, which then belong to one piece.
      const bool joined = (v[0] + v[1] + v[2] + v[3] < 0) == (v[0] < 0);
      out.push_back({crossing[0], crossing[joined ? 1 : 3]});
      out.push_back({crossing[2], crossing[joined ? 3 : 1]});
    }
  }
}

}  // namespace truestep
