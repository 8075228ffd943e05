// Positions from images: pinhole cameras with z along the viewing direction, x to the right and y down in the
// image,
//   u = cu + f x/z,   v = cv + f y/z   (Hartley, Zisserman 2004, eq. 6.3).
// A position is first the point closest to its rays, sum |(I - d d^T)(p - o)|^2 -> min, then refined by
// Gauss-Newton to the least squared reprojection error (Hartley, Sturm 1997). If some sightings are of
// something else, it is the position from the pair that most other sightings agree with (RANSAC, Fischler,
// Bolles 1981, with all pairs tried).
#pragma once
#include <optional>
#include <span>

#include "engine/geometry/shape.h"
#include "engine/kernels/animation/rotations.h"

namespace truestep::animation {

struct PinholeCamera {
  Pose pose;                  ///< in the world
  double focal = 1000;        ///< pixels
  double middle[2] = {0, 0};  ///< pixels
};
/// A camera at `from` that looks at `at`, with the world's `up` upwards in its image.
PinholeCamera camera_looking_at(const Vec3& from, const Vec3& at, const Vec3& up, double focal,
                                double middle_u, double middle_v);

struct ImagePoint {
  double u = 0, v = 0;  ///< pixels
};
/// Empty if the position is not in front of the camera.
std::optional<ImagePoint> project(const PinholeCamera& camera, const Vec3& place);

struct Sighting {
  uint32_t camera = 0;
  ImagePoint at;
};
struct Triangulated {
  Vec3 place;
  double residual = 0;  ///< pixels, root mean square reprojection error of u and v
};
/// Empty if fewer than two cameras see the point, their rays are parallel, or it lies behind one of them.
std::optional<Triangulated> triangulate(std::span<const PinholeCamera> cameras,
                                        std::span<const Sighting> seen);

/// Noise of one image coordinate in pixels, from the median reprojection error of the given positions, each
/// with its number of sightings; at least a twentieth of a pixel.
double picture_noise(std::span<const Triangulated> found, std::span<const uint32_t> sightings);
struct Agreed {
  Triangulated found;
  uint32_t used = 0;  ///< sightings that agree
};
/// From all sightings if none is off by more than six times `noise` (pixels), otherwise from those that agree
/// with the position to within 4.7 times. Empty if no two sightings agree.
std::optional<Agreed> triangulate_agreed(std::span<const PinholeCamera> cameras,
                                         std::span<const Sighting> seen, double noise);

}  // namespace truestep::animation
