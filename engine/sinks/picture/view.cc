#include "engine/sinks/picture/view.h"

#include <algorithm>
#include <cmath>

#include "engine/sinks/picture/color_map.h"

namespace truestep::picture {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kReach =
    8;  // things farther from the target than this many eye distances do not shape the view

constexpr double kLeastShadowHalf =
    0.25;  // picture units; keeps point sprites within the driver's largest size

void set(float (&to)[4], const Vec3& v, double w) {
  to[0] = static_cast<float>(v.x), to[1] = static_cast<float>(v.y), to[2] = static_cast<float>(v.z);
  to[3] = static_cast<float>(w);
}

Vec3 linear(const Color& c) {
  return {linear_from_srgb(c.r), linear_from_srgb(c.g), linear_from_srgb(c.b)};
}

// Pictures are stored top row first, so y points down in clip space and no copy has to be flipped.
Mat4 projection(const View& v) {
  Mat4 p;
  const double f = 2 / (v.pixel * v.height);
  p.at(0, 0) = static_cast<float>(f * v.height / v.width);
  p.at(1, 1) = static_cast<float>(-f);
  p.at(2, 2) = static_cast<float>(-(v.far_plane + v.near_plane) / (v.far_plane - v.near_plane));
  p.at(2, 3) = static_cast<float>(-2 * v.far_plane * v.near_plane / (v.far_plane - v.near_plane));
  p.at(3, 2) = -1;
  return p;
}

// The casters' box -> [0, 1]^3, depth growing away from the light.
Mat4 light_matrix(const View& v, const Extent& e, double& texel, double& depth_texels) {
  double half = kLeastShadowHalf, centre[3] = {0, 0, 0}, depth = 1;
  if (e.lo[0] <= e.hi[0]) {
    for (int i = 0; i < 3; ++i) centre[i] = (e.lo[i] + e.hi[i]) / 2;
    half = std::max({(e.hi[0] - e.lo[0]) / 2, (e.hi[1] - e.lo[1]) / 2, kLeastShadowHalf}) * 1.02;
    depth = std::max(e.hi[2] - e.lo[2], 1e-3) * 1.02;
  }
  texel = 2 * half / v.shadow_side;
  depth_texels = depth / texel;
  Mat4 m = to_basis(v.light_side, v.light_above, v.light, {0, 0, 0});
  const double scale[3] = {0.5 / half, 0.5 / half, -1 / depth};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) m.at(row, column) *= static_cast<float>(scale[row]);
    m.at(row, 3) = static_cast<float>(0.5 - scale[row] * centre[row]);
  }
  return m;
}

}  // namespace

View::View(const DrawList& list, int w, int h)
    : camera(camera_for(list, static_cast<double>(w) / h)), axes(axes_of(list.up)), width(w), height(h) {
  const double distance = norm(camera.eye - camera.target);
  units = {camera.target, 1 / distance};
  eye = (camera.eye - camera.target) / distance;
  back = eye;
  Vec3 upward = axes_of(*camera.up).up;
  if (norm2(cross(upward, back)) < 1e-8) upward = axes.front;  // looking straight down
  right = normalized(cross(upward, back));
  above = cross(back, right);
  // From above, the left and the front: shadows fall away from the viewer and every edge gets a lit side.
  light = normalized(axes.up * 1.0 - axes.side * 0.5 + axes.front * 0.45);
  light_side = normalized(cross(axes.up, light), axes.side);
  light_above = cross(light, light_side);
  shadow_side = std::max(w, h) <= 1200 ? 1024 : 2048;
  near_plane = 0.004;
  far_plane = 200;
  pixel = 2 * std::tan(camera.fov_degrees * kDegree / 2) / h;
}

void Extent::add(const View& view, const Vec3f& p, float r) {
  const Vec3 q{p.x, p.y, p.z};
  const double reach = norm(q) + r;
  if (!(reach < kReach)) return;
  radius = std::max(radius, reach);
  const Vec3 light_axes[3] = {view.light_side, view.light_above, view.light};
  for (int i = 0; i < 3; ++i) {
    const double c = dot(q, light_axes[i]);
    lo[i] = std::min(lo[i], c - r);
    hi[i] = std::max(hi[i], c + r);
  }
}

Uniforms make_uniforms(const DrawList& list, const View& v, const Extent& extent, double ground_height) {
  Uniforms u{};
  u.view_projection = projection(v) * to_basis(v.right, v.above, v.back, v.eye);
  double texel = 0, depth_texels = 0;
  u.light_matrix = light_matrix(v, extent, texel, depth_texels);
  set(u.eye, v.eye, v.pixel);
  set(u.forward, -v.back, v.near_plane);
  set(u.camera_up, v.above, 0);
  set(u.light, v.light, texel);
  const double range = v.far_plane - v.near_plane;
  set(u.depth,
      {(v.far_plane + v.near_plane) / range, -2 * v.far_plane * v.near_plane / range,
       static_cast<double>(v.shadow_side)},
      depth_texels);
  set(u.viewport, {static_cast<double>(v.width), static_cast<double>(v.height), 0}, 0);

  // Grid lines are fixed in the scene: the centre below the target snaps to the nearest crossing.
  const double reach = std::max(extent.radius, 0.05);
  const double major = std::pow(10.0, std::ceil(std::log10(reach / v.units.scale / 4)));  // m
  const auto snapped = [&](const Vec3& axis) {
    return axis * (std::round(dot(v.units.origin, axis) / major) * major);
  };
  const Vec3 centre = snapped(v.axes.side) + snapped(v.axes.front) + v.axes.up * ground_height;
  const double above_ground = dot(v.camera.eye, v.axes.up) > ground_height ? 1 : 0;
  set(u.up, v.axes.up, above_ground);
  set(u.ground_centre, (centre - v.units.origin) * v.units.scale, std::max(4.0 * reach, 2.0));
  set(u.ground_side, v.axes.side, major * v.units.scale / 10);
  set(u.ground_front, v.axes.front, major * v.units.scale);
  set(u.background_top, linear(list.background_top), 0);
  set(u.background_bottom, linear(list.background_bottom), 0);
  return u;
}

}  // namespace truestep::picture
