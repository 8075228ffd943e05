// The automatic camera of a picture: everything drawn is inside, with little to spare.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/sinks/picture/camera.h"
#include "tests/unit/pictures/picture_lists.h"
#include "tests/unit/pictures/picture_pixels.h"

namespace truestep {
namespace {

using test::one_sphere;

// Angle of p from the camera's axis, horizontally and vertically, relative to half the picture.
std::pair<double, double> place(const DrawCamera& camera, double aspect, const Vec3& p) {
  const Vec3 back = normalized(camera.eye - camera.target), right = normalized(cross(*camera.up, back));
  const Vec3 above = cross(back, right), q = p - camera.eye;
  const double depth = -dot(q, back), k = std::tan(camera.fov_degrees * M_PI / 360);
  return {dot(q, right) / (depth * k * aspect), dot(q, above) / (depth * k)};
}

TEST(Picture, AutomaticCameraHoldsEveryPointWithLittleToSpare) {
  for (const Vec3& up : {Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{-1, 0, 0}})
    for (double aspect : {0.5, 1.0, 2.4}) {
      DrawList list = test::fountain(300);
      list.up = up;
      const DrawCamera camera = picture::camera_for(list, aspect);
      double widest = 0;
      const std::vector<float>& x = list.points[0].positions;
      for (size_t i = 0; i < x.size(); i += 3) {
        const auto [u, v] = place(camera, aspect, {x[i], x[i + 1], x[i + 2]});
        widest = std::max({widest, std::abs(u), std::abs(v)});
      }
      EXPECT_LE(widest, 1.0);
      EXPECT_GE(widest, 0.8);  // control: a camera that is merely far away fails
    }
  EXPECT_GT(norm(picture::camera_for({}, 1).eye), 0);
  DrawList lone = one_sphere({});
  lone.camera.reset();
  lone.points[0].radius = 0;
  lone.points[0].positions = {1e6f, 0, 0};
  const DrawCamera camera = picture::camera_for(lone, 1);
  EXPECT_GT(norm(camera.eye - camera.target), 0);
}

}  // namespace
}  // namespace truestep
