#include "engine/geometry/make/hair.h"

#include <cmath>

namespace truestep {

std::vector<Vec3> hair_points(const HairShape& shape) {
  const auto points = static_cast<size_t>(shape.links) + 1;
  const Vec3 direction = normalized(shape.direction);
  const Vec3 other = std::abs(direction.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalized(cross(direction, other)), w = cross(direction, u);
  const double link = shape.length / shape.links;

  // Sunflower: root s is turned by s golden angles (cosine and sine of 2.39996... rad) at radius sqrt(s).
  constexpr double kCos = -0.73736887807831963, kSin = 0.67549029426152396;
  double c = 1, s = 0;
  std::vector<Vec3> x;
  for (int strand = 0; strand < shape.strands; ++strand) {
    const double r = shape.radius * std::sqrt((strand + 0.5) / shape.strands);
    const Vec3 root = shape.root + (r * c) * u + (r * s) * w;
    for (size_t i = 0; i < points; ++i) x.push_back(root + (link * static_cast<double>(i)) * direction);
    const double turned = c * kCos - s * kSin;
    s = s * kCos + c * kSin, c = turned;
  }
  return x;
}

}  // namespace truestep
