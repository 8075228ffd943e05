#include "engine/sinks/picture/geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/errors.h"
#include "engine/sinks/picture/color_map.h"

namespace truestep::picture {
namespace {

constexpr double kSpritePixels = 5;     // radius below which flat depth cannot be distinguished from a ball's
constexpr double kSpriteRadius = 0.01;  // picture units
constexpr float kVisible = 1e4f;  // picture units; beyond it a coordinate is off the far plane by any account

bool drawable(const Vec3f& p) {
  return std::abs(p.x) < kVisible && std::abs(p.y) < kVisible && std::abs(p.z) < kVisible;  // false for NaN
}

[[noreturn]] void refuse(size_t set, const std::string& what) {
  throw Error("invalid_draw_list", "points[" + std::to_string(set) + "]: " + what);
}

void check(const DrawPoints& set, size_t index) {
  if (set.positions.size() % 3) refuse(index, "positions are not triples");
  const size_t n = set.positions.size() / 3;
  if (!set.radii.empty() && set.radii.size() != n) refuse(index, "one radius per point is needed");
  if (!set.scalar.empty() && set.scalar.size() != n) refuse(index, "one scalar per point is needed");
  if (set.lines.size() % 2) refuse(index, "lines are not pairs");
  if (set.triangles.size() % 3) refuse(index, "triangles are not triples");
  if (!set.line_kinds.empty() && 2 * set.line_kinds.size() != set.lines.size())
    refuse(index, "one kind per line is needed");
  if (!set.line_scalar.empty() && 2 * set.line_scalar.size() != set.lines.size())
    refuse(index, "one scalar per line is needed");
  if (!set.triangle_scalar.empty() && 3 * set.triangle_scalar.size() != set.triangles.size())
    refuse(index, "one scalar per triangle is needed");
  for (const std::vector<uint32_t>* indices : {&set.lines, &set.triangles})
    for (uint32_t i : *indices)
      if (i >= n) refuse(index, "index " + std::to_string(i) + " but only " + std::to_string(n) + " points");
}

// Colours of `values` by the set's map, or `base` without values.
std::vector<Bytes4> mapped_colors(const DrawPoints& set, const std::vector<float>& values, size_t n,
                                  const Color& base, Paper paper) {
  std::vector<Bytes4> colors(n, bytes_of(base));
  if (values.empty()) return colors;
  const auto [low, high] = scalar_range(set);
  std::array<Bytes4, 256> table;
  for (size_t i = 0; i < table.size(); ++i)
    table[i] = bytes_of(color_at(set, static_cast<float>(i) / 255, paper));
  const float scale = high > low ? 255 / (high - low) : 0;
  for (size_t i = 0; i < n; ++i) {
    const float t = (values[i] - low) * scale;
    colors[i] = table[t > 0 ? static_cast<size_t>(std::min(t, 255.0f)) : 0];
  }
  return colors;
}

// Structural springs have full colour; shear and bending springs are fainter so that a net stays readable.
std::array<Bytes4, 4> line_colors(const Color& base) {
  return {bytes_of(base), bytes_of(mixed(base, {1, 1, 1}, 0.35f)),
          bytes_of(mixed(base, {0.62f, 0.64f, 0.68f}, 0.7f)),
          bytes_of(mixed(base, {0.5f, 0.5f, 0.5f}, 0.3f))};
}

void add_surface(Geometry& g, const View& view, const DrawPoints& set, const std::vector<Vec3f>& p,
                 const std::vector<Bytes4>& colors, const Color& base, Paper paper) {
  std::vector<Vec3f> normals(p.size());
  std::vector<uint32_t> drawn;
  const auto first = static_cast<uint32_t>(g.mesh.size());
  for (size_t t = 0; t + 2 < set.triangles.size(); t += 3) {
    const uint32_t a = set.triangles[t], b = set.triangles[t + 1], c = set.triangles[t + 2];
    if (!drawable(p[a]) || !drawable(p[b]) || !drawable(p[c])) continue;
    const Vec3f area = cross(p[b] - p[a], p[c] - p[a]);
    for (uint32_t i : {a, b, c}) normals[i] += area;
    drawn.push_back(static_cast<uint32_t>(t / 3));
  }
  // A vertex without a normal keeps its colour regardless of the light.
  const bool lit = set.surface == DrawPoints::Surface::lit;
  const auto add = [&](size_t i, const Bytes4& color) {
    g.mesh.push_back({p[i], lit ? normalized(normals[i], {0, 1, 0}) : Vec3f{}, color});
  };
  for (size_t i = 0; i < p.size(); ++i) {
    if (norm2(normals[i]) > 0) g.extent.add(view, p[i], 0);
  }
  if (set.triangle_scalar.empty()) {
    for (size_t i = 0; i < p.size(); ++i) add(i, colors[i]);
    for (const uint32_t t : drawn) {
      for (size_t c = 0; c < 3; ++c) g.triangles.push_back(first + set.triangles[3 * t + c]);
    }
    return;
  }
  // Neighbours differ in colour: every triangle has corners of its own.
  const std::vector<Bytes4> own =
      mapped_colors(set, set.triangle_scalar, set.triangle_scalar.size(), base, paper);
  for (const uint32_t t : drawn) {
    for (size_t c = 0; c < 3; ++c) {
      g.triangles.push_back(static_cast<uint32_t>(g.mesh.size()));
      add(set.triangles[3 * t + c], own[t]);
    }
  }
}

// Low values are transparent, high ones dim what is behind them.
void add_translucent(Geometry& g, const View& view, const DrawPoints& set, const std::vector<Vec3f>& p,
                     std::vector<Bytes4> colors) {
  constexpr float kLeast = 0.03f, kMost = 0.5f;
  const auto [low, high] = scalar_range(set);
  for (size_t i = 0; i < colors.size() && i < set.scalar.size(); ++i) {
    const float t = high > low ? std::clamp((set.scalar[i] - low) / (high - low), 0.0f, 1.0f) : 1.0f;
    colors[i][3] = static_cast<uint8_t>(255 * (kLeast + (kMost - kLeast) * t));
  }
  for (const uint32_t i : set.triangles) {
    g.glass.push_back({p[i], {}, colors[i]});
    g.extent.add(view, p[i], 0);
  }
  sort_far_to_near(g.glass, view);
}

// Half this many pixels of a picture 720 high, at this position, in picture units.
float half_pixels(const View& view, const Vec3f& p, double pixels) {
  const double depth = -dot(Vec3{p.x, p.y, p.z} - view.eye, view.back);
  const double scaled = pixels > 0 ? std::max(1.5, pixels * view.height / 720) : 0;
  return static_cast<float>(0.5 * scaled * std::max(depth, 0.0) * view.pixel);
}

void add_points(Geometry& g, const View& view, const DrawPoints& set, const Color& base, Paper paper) {
  const size_t n = set.positions.size() / 3;
  std::vector<Vec3f> p(n);
  for (size_t i = 0; i < n; ++i) {
    const Vec3f q = load3(set.positions.data(), i);
    p[i] = view.units.position({q.x, q.y, q.z});
  }
  const std::vector<Bytes4> colors = mapped_colors(set, set.scalar, n, base, paper);
  for (size_t i = 0; i < n; ++i) {
    const float r = std::max(view.units.length(set.radii.empty() ? set.radius : set.radii[i]),
                             half_pixels(view, p[i], set.point_pixels));
    if (r > 0 && drawable(p[i])) g.add_sphere(view, p[i], r, colors[i]);
  }
  std::array<Bytes4, 4> tints = line_colors(set.line_color.value_or(base));
  for (Bytes4& tint : tints) tint[3] = set.exact_lines ? 0 : 255;
  const std::vector<Bytes4> line_tints =
      mapped_colors(set, set.line_scalar, set.line_scalar.size(), base, paper);
  const float thickness = std::max(0.0f, view.units.length(set.line_radius));
  for (size_t l = 0; 2 * l + 1 < set.lines.size(); ++l) {
    const Vec3f a = p[set.lines[2 * l]], b = p[set.lines[2 * l + 1]];
    const size_t kind = set.line_kinds.empty() ? 0 : std::min<size_t>(set.line_kinds[l], 3);
    if (!drawable(a) || !drawable(b)) continue;
    const float least = half_pixels(view, (a + b) * 0.5f, set.line_pixels);
    g.add_line(view, a, b, std::max(thickness, least), set.line_scalar.empty() ? tints[kind] : line_tints[l]);
  }
  if (set.surface == DrawPoints::Surface::translucent) {
    add_translucent(g, view, set, p, colors);
  } else if (!set.triangles.empty()) {
    add_surface(g, view, set, p, colors, base, paper);
  }
}

// Small both in the picture and in the shadow map (whose texels have a minimum width), and with its centre
// inside the picture, outside of which a point would be clipped as a whole.
bool is_sprite(const View& view, const Vec3f& centre, float radius) {
  const Vec3 c = Vec3{centre.x, centre.y, centre.z} - view.eye;
  const double depth = -dot(c, view.back), half = depth * view.pixel * view.height / 2;
  return depth > view.near_plane && radius < kSpritePixels * depth * view.pixel && radius < kSpriteRadius &&
         std::abs(dot(c, view.above)) < half &&
         std::abs(dot(c, view.right)) < half * view.width / view.height;
}

// Counting sort on depth in buckets: stable, linear, and exact order within a bucket does not matter.
void sort_near_to_far(std::vector<SphereVertex>& sprites, const View& view) {
  constexpr size_t kBuckets = 4096;
  std::vector<double> depth(sprites.size());
  double near = std::numeric_limits<double>::infinity(), far = -near;
  for (size_t i = 0; i < sprites.size(); ++i) {
    const Vec3f& c = sprites[i].centre;
    depth[i] = -dot(Vec3{c.x, c.y, c.z}, view.back);
    near = std::min(near, depth[i]), far = std::max(far, depth[i]);
  }
  const double scale = far > near ? (kBuckets - 1) / (far - near) : 0;
  std::array<size_t, kBuckets + 1> start{};
  const auto bucket = [&](size_t i) { return static_cast<size_t>((depth[i] - near) * scale); };
  for (size_t i = 0; i < sprites.size(); ++i) ++start[bucket(i) + 1];
  for (size_t b = 0; b < kBuckets; ++b) start[b + 1] += start[b];
  std::vector<SphereVertex> sorted(sprites.size());
  for (size_t i = 0; i < sprites.size(); ++i) sorted[start[bucket(i)]++] = sprites[i];
  sprites.swap(sorted);
}

bool level(const DrawShape& plane, const Vec3& up) {
  return plane.kind == DrawShape::Kind::plane && dot(normalized(plane.size), up) > 0.9999;
}

}  // namespace

bool has_scalars(const DrawPoints& set) {
  return !(set.scalar.empty() && set.line_scalar.empty() && set.triangle_scalar.empty());
}

std::pair<float, float> scalar_range(const DrawPoints& set) {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (const float s : !set.line_scalar.empty()       ? set.line_scalar
                       : !set.triangle_scalar.empty() ? set.triangle_scalar
                                                      : set.scalar)
    if (std::isfinite(s)) low = std::min(low, s), high = std::max(high, s);
  if (!(low <= high)) low = 0, high = 1;
  if (set.color_map == ColorMap::balance) {
    const float reach = std::max(std::abs(low), std::abs(high));
    low = -reach, high = reach;
  }
  return {set.scalar_min.value_or(low), set.scalar_max.value_or(high)};
}

Color color_at(const DrawPoints& set, float t, Paper paper) {
  if (set.kinds.empty()) return map_color(set.color_map, t, paper);
  const auto n = static_cast<float>(set.kinds.size());
  return set.kinds[t > 0 ? static_cast<size_t>(std::min(t * n, n - 1)) : 0].color;
}

void sort_far_to_near(std::vector<MeshVertex>& glass, const View& view) {
  using Triangle = std::array<MeshVertex, 3>;
  std::vector<std::pair<double, Triangle>> order;
  for (size_t i = 0; i + 2 < glass.size(); i += 3) {
    const Vec3f c = glass[i].position + glass[i + 1].position + glass[i + 2].position;
    order.push_back({dot(Vec3{c.x, c.y, c.z}, view.back), {glass[i], glass[i + 1], glass[i + 2]}});
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (size_t i = 0; i < order.size(); ++i) std::copy_n(order[i].second.begin(), 3, glass.begin() + 3 * i);
}

Bytes4 bytes_of(const Color& c) {
  const auto byte = [](float x) { return static_cast<uint8_t>(x > 0 ? std::min(x, 1.0f) * 255 + 0.5f : 0); };
  return {byte(c.r), byte(c.g), byte(c.b), 255};
}

void Geometry::add_sphere(const View& view, const Vec3f& centre, float radius, Bytes4 color) {
  if (is_sprite(view, centre, radius)) {
    sprites.push_back({centre, radius, color});
  } else {
    spheres.insert(spheres.end(), 4, {centre, radius, color});
  }
  extent.add(view, centre, radius);
}

void Geometry::add_line(const View& view, const Vec3f& a, const Vec3f& b, float radius, Bytes4 color) {
  lines.insert(lines.end(), 4, {a, b, radius, color});
  extent.add(view, a, radius);
  extent.add(view, b, radius);
}

void Geometry::build(const DrawList& list, const View& view) {
  spheres.clear(), sprites.clear(), lines.clear(), marks.clear(), mesh.clear(), triangles.clear(),
      glass.clear();
  extent = {};
  ground_height = list.ground_height;
  const Paper paper = paper_of(list.background_bottom);
  for (size_t i = 0; i < list.points.size(); ++i) {
    check(list.points[i], i);
    add_points(*this, view, list.points[i], list.points[i].color.value_or(palette(i)), paper);
  }
  for (const DrawShape& shape : list.shapes)
    if (shape.kind != DrawShape::Kind::plane) add_shape(*this, view, shape);
  for (const DrawShape& shape : list.shapes) {
    if (shape.kind != DrawShape::Kind::plane) continue;
    if (!ground_height && level(shape, view.axes.up)) {
      ground_height = dot(shape.position, view.axes.up);
    } else if (!level(shape, view.axes.up) || dot(shape.position, view.axes.up) != *ground_height) {
      add_shape(*this, view, shape);
    }
  }
  for (const DrawMark& m : list.marks) {
    const Vec3f from = view.units.position(m.from), to = view.units.position(m.to);
    if (!drawable(from) || !drawable(to)) continue;
    const float radius = view.units.length(m.radius);
    marks.insert(marks.end(), 4, {from, to, radius, bytes_of(m.color)});
    if (m.framed) extent.add(view, from, radius), extent.add(view, to, radius);
  }
  sort_near_to_far(sprites, view);
}

}  // namespace truestep::picture
