// Triangles of a face that a file gives by its corners. In the plane of the face (its normal by Newell 1972)
// a convex one is cut into a fan from its first corner, any other by clipping ears (Meisters 1975); the
// triangles run as the face does. Corners on one straight line, corners that repeat the one before and edges
// that lead to a hole and back are read. What has no single meaning is refused: faces that cross
// themselves or run over an edge twice, and faces so far off a plane that the two ways of cutting a
// quadrangle differ by a fold of thirty degrees.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

class PolygonCutter {
 public:
  /// Appends the triangles of the face to `out`. Returns why there are none, or nothing when all is well.
  /// Needs three corners or more and valid indices.
  std::string cut(std::span<const Vec3> vertices, std::span<const uint32_t> corners,
                  std::vector<std::array<uint32_t, 3>>& out);

 private:
  struct Flat {
    double x, y;
  };
  double turn(size_t a, size_t b, size_t c) const;
  bool same(size_t a, size_t b) const;
  bool flatten(std::span<const Vec3> vertices, std::string& why);
  bool convex() const;
  std::string crossing() const;
  bool ear(size_t b) const;
  bool clip(std::vector<std::array<uint32_t, 3>>& out);

  std::vector<uint32_t> corners_;
  std::vector<Flat> at_;  ///< in units of the face's extent
  std::vector<size_t> before_, after_;
  double work_ = 0;  ///< corners squared of all faces that are not convex
};

}  // namespace truestep
