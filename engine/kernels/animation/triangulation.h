// Places from pictures: cameras are pinholes whose z axis looks ahead, x to the right and y down the picture,
//   u = cu + f x/z,   v = cv + f y/z   (Hartley, Zisserman 2004, eq. 6.3).
// A place is where its rays come nearest to each other, sum |(I - d d^T)(p - o)|^2 -> min, then where the
// squares of what is left in the pictures are least (Hartley, Sturm 1997), by Gauss-Newton. Among sightings
// some of which are of something else, the place is that of the pair that most others agree with (Fischler,
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
/// A camera at `from` that looks at a place, with the world's `up` upwards in its picture.
PinholeCamera camera_looking_at(const Vec3& from, const Vec3& at, const Vec3& up, double focal,
                                double middle_u, double middle_v);

struct ImagePoint {
  double u = 0, v = 0;  ///< pixels
};
/// Nothing where the place is not in front of the camera.
std::optional<ImagePoint> project(const PinholeCamera& camera, const Vec3& place);

struct Sighting {
  uint32_t camera = 0;
  ImagePoint at;
};
struct Triangulated {
  Vec3 place;
  double residual = 0;  ///< pixels, root of the mean square of what is left in u and v
};
/// Nothing where fewer than two cameras see it, where their rays are parallel, or where it lies behind one.
std::optional<Triangulated> triangulate(std::span<const PinholeCamera> cameras,
                                        std::span<const Sighting> seen);

/// Pixels, of one coordinate: what is left in pictures of places, each with its count of sightings, by the
/// median; not below a twentieth of a pixel.
double picture_noise(std::span<const Triangulated> found, std::span<const uint32_t> sightings);
struct Agreed {
  Triangulated found;
  uint32_t used = 0;  ///< sightings that agree
};
/// With all sightings where none is more than six times `noise` (pixels) off, else with those that agree with
/// the place within 4.7 times. Nothing where no two agree.
std::optional<Agreed> triangulate_agreed(std::span<const PinholeCamera> cameras,
                                         std::span<const Sighting> seen, double noise);

}  // namespace truestep::animation
