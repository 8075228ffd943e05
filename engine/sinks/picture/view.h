// The one uniform block that all shaders share, and the units they work in: the camera's target is the origin
// and the distance from eye to target is 1, so a molecule and a galaxy lead to the same single-precision
// numbers.
#pragma once
#include "engine/sinks/picture/camera.h"
#include "engine/sinks/picture/mat4.h"

namespace truestep::picture {

/// Scene metres -> picture units.
struct Units {
  Vec3 origin;
  double scale = 1;

  Vec3f position(const Vec3& p) const {
    const Vec3 q = (p - origin) * scale;
    return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)};
  }
  float length(double metres) const { return static_cast<float>(metres * scale); }
};

/// Camera, light and units of one picture, known before any geometry is built.
struct View {
  View(const DrawList& list, int width, int height);

  DrawCamera camera;
  Axes axes;
  Units units;
  Vec3 eye;                             ///< picture units
  Vec3 right, above, back;              ///< camera axes
  Vec3 light, light_side, light_above;  ///< direction to the key light, and two axes across it
  double near_plane, far_plane;         ///< picture units
  double pixel;                         ///< size of a pixel at distance 1
  int width, height;
  int shadow_side;  ///< texels of the shadow map, about the picture's pixels
};

/// Axis-aligned box in the light's axes around everything that casts a shadow, and the reach of the scene.
struct Extent {
  double lo[3] = {1e30, 1e30, 1e30}, hi[3] = {-1e30, -1e30, -1e30};
  double radius = 0;  ///< farthest drawn thing from the target, outliers aside; picture units

  void add(const View& view, const Vec3f& p, float r);
};

/// std140 layout of the block `Scene` (see shaders.cc); vectors are padded to four.
struct Uniforms {
  Mat4 view_projection, light_matrix;
  float eye[4];      ///< w: size of a pixel at distance 1
  float forward[4];  ///< w: near plane
  float camera_up[4];
  float light[4];     ///< w: size of a shadow texel
  float up[4];        ///< w: 1 when the camera is above the ground, else 0
  float depth[4];     ///< ndc z = depth.x + depth.y / distance; z: shadow map side in texels; w: its depth in
                      ///< texels
  float viewport[4];  ///< width, height
  float ground_centre[4];                         ///< w: radius at which the ground has faded
  float ground_side[4];                           ///< w: distance of minor grid lines
  float ground_front[4];                          ///< w: distance of major grid lines
  float background_top[4], background_bottom[4];  ///< linear light
};

Uniforms make_uniforms(const DrawList& list, const View& view, const Extent& extent, double ground_height);

}  // namespace truestep::picture
