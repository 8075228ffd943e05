#include "engine/sinks/picture/draw_world.h"

#include <cmath>
#include <cstdio>

#include "engine/math/quaternion.h"

namespace truestep {

namespace {

std::vector<float> floats_of(const FieldView& view) {
  std::vector<float> out(view.rows * view.width);
  if (view.type == Scalar::f64) {
    const auto* v = static_cast<const double*>(view.data);
    for (size_t i = 0; i < out.size(); ++i) out[i] = static_cast<float>(v[i]);
  } else if (view.type == Scalar::f32) {
    const auto* v = static_cast<const float*>(view.data);
    out.assign(v, v + out.size());
  }
  return out;
}

// Length of each row: colours show the size of a vector field, or the value of a scalar one.
std::vector<float> magnitudes(const std::vector<float>& values, uint32_t width) {
  std::vector<float> out(values.size() / width);
  for (size_t i = 0; i < out.size(); ++i) {
    float sum = 0;
    for (uint32_t c = 0; c < width; ++c) sum += values[i * width + c] * values[i * width + c];
    out[i] = width == 1 ? values[i] : std::sqrt(sum);
  }
  return out;
}

// "speed" is understood for every system that has velocities.
std::string_view field_for(std::string_view color_by) {
  return color_by == "speed" ? "velocity" : color_by;
}

DrawPoints points_of(const System& system, const State& state, const std::string& color_by) {
  DrawPoints points;
  std::vector<double> scratch;
  const auto infos = system.fields();
  for (size_t f = 0; f < infos.size(); ++f) {
    if (infos[f].name == "position" && infos[f].width == 3)
      points.positions = floats_of(system.field(state, f, scratch));
  }
  for (size_t f = 0; f < infos.size() && !color_by.empty(); ++f) {
    if (infos[f].name != color_by && infos[f].name != field_for(color_by)) continue;
    points.scalar = magnitudes(floats_of(system.field(state, f, scratch)), infos[f].width);
    if (points.scalar.size() * 3 != points.positions.size())
      points.scalar.clear();
    else
      points.scalar_label = color_by + " (" + infos[f].unit + ")";
    break;
  }
  const Topology topology = system.topology(state);
  points.radius = static_cast<float>(topology.point_radius);
  points.line_radius = points.radius / 4;
  const auto n = static_cast<uint32_t>(points.positions.size() / 3);
  for (size_t i = 0; i < topology.lines.size(); ++i) {
    const auto& l = topology.lines[i];
    if (l[0] >= n || l[1] >= n) continue;
    points.lines.insert(points.lines.end(), {l[0], l[1]});
    points.line_kinds.push_back(i < topology.line_kinds.size() ? static_cast<uint8_t>(topology.line_kinds[i])
                                                               : 0);
  }
  for (const auto& t : topology.triangles) {
    if (t[0] < n && t[1] < n && t[2] < n) points.triangles.insert(points.triangles.end(), {t[0], t[1], t[2]});
  }
  // Under a surface its springs would only be noise.
  if (!points.triangles.empty()) points.lines.clear(), points.line_kinds.clear();
  if (topology.color) {
    const auto& c = *topology.color;
    points.color = Color{static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
  }
  return points;
}

DrawShape shape_of(const DrawnShape& s) {
  DrawShape d;
  d.kind = s.kind, d.mesh = s.mesh;
  d.position = s.position;
  for (size_t i = 0; i < 4; ++i) d.orientation[i] = s.orientation[i];
  d.size = s.size;
  d.container = s.container;
  return d;
}

// Pictures stand upright: up is the axis that gravity points against; y when there is none, or a slanted one.
Vec3 up_of(const Vec3& gravity) {
  const Vec3 up = normalized(-gravity, {0, 1, 0});
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 0, 1}}) {
    if (std::abs(dot(up, axis)) > 0.9) return axis * (dot(up, axis) > 0 ? 1.0 : -1.0);
  }
  return {0, 1, 0};
}

/// How far (m) a shape reaches from its position against `up`.
double reach_down(const DrawShape& s, const Vec3& up) {
  const Rotation r =
      rotation(normalized(Quat{s.orientation[0], s.orientation[1], s.orientation[2], s.orientation[3]}));
  const Vec3 own = r.apply_inverse(up);
  const double side = std::sqrt(std::max(0.0, 1 - own.y * own.y));
  switch (s.kind) {
    case DrawShape::Kind::box:
      return std::abs(own.x) * s.size.x + std::abs(own.y) * s.size.y + std::abs(own.z) * s.size.z;
    case DrawShape::Kind::capsule:
      return s.size.x + std::abs(own.y) * s.size.y;
    case DrawShape::Kind::cylinder:
      return side * s.size.x + std::abs(own.y) * s.size.y;
    case DrawShape::Kind::mesh: {
      double reach = -HUGE_VAL;
      for (size_t i = 0; s.mesh && i < s.mesh->positions.size() / 3; ++i) {
        const Vec3f p = load3(s.mesh->positions.data(), i);
        reach = std::max(reach, -dot(own, Vec3{p.x, p.y, p.z}));
      }
      return reach;
    }
    default:
      return s.size.x;
  }
}

/// Longest line of a mark (m): what is in the picture, less a lot.
double mark_size(const DrawList& list) {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
  const auto cover = [&](const Vec3& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  };
  for (const DrawShape& s : list.shapes) {
    if (s.kind != DrawShape::Kind::plane && s.framing == DrawShape::Framing::counts) cover(s.position);
  }
  for (const DrawPoints& p : list.points) {
    for (size_t i = 0; i < p.positions.size() / 3; ++i) {
      const Vec3f x = load3(p.positions.data(), i);
      if (std::isfinite(x.x + x.y + x.z)) cover({x.x, x.y, x.z});
    }
  }
  const double size = norm(high - low);
  return std::isfinite(size) && size > 0 ? 0.08 * size : 0.2;
}

// The ground lies under everything that is drawn.
double lowest_point(const DrawList& list) {
  double low = HUGE_VAL;
  for (const DrawPoints& p : list.points) {
    for (size_t i = 0; i + 2 < p.positions.size(); i += 3) {
      const Vec3f x = load3(p.positions.data(), i / 3);
      const double height = dot(Vec3{x.x, x.y, x.z}, list.up);
      if (std::isfinite(height)) low = std::min(low, height - p.radius);
    }
  }
  for (const DrawShape& s : list.shapes) {
    if (s.kind != DrawShape::Kind::plane)
      low = std::min(low, dot(s.position, list.up) - reach_down(s, list.up));
  }
  return low;
}

}  // namespace

DrawList draw_list_of(const World& world, const WorldState& state, Overlay overlay) {
  DrawList list;
  const SceneHeader& header = world.scene().header;
  const double t = static_cast<double>(state.step) * world.dt();
  list.up = up_of(header.gravity);
  bool has_plane = false;
  for (size_t i = 0; i < world.size(); ++i) {
    DrawPoints points = points_of(world.system(i), state.systems[i], header.viewer.color_by);
    const size_t before = list.shapes.size();
    add_bodies(list, world.system(i), state.systems[i], points);
    // Rows that only carry bodies are not looked at either; coloured ones bring the colour bar.
    const bool only_bodies = list.shapes.size() > before && points.radius == 0 && points.lines.empty() &&
                             points.triangles.empty() && points.scalar.empty();
    if (!points.positions.empty() && !only_bodies) list.points.push_back(std::move(points));
    for (const DrawnShape& s : world.system(i).shapes(state.systems[i], t)) {
      list.shapes.push_back(shape_of(s));
      has_plane |= s.kind == DrawnShape::Kind::plane;
    }
  }
  if (const double low = lowest_point(list); !has_plane && std::isfinite(low))
    list.ground_height = low - 0.05;
  if (overlay != Overlay::none) {
    const double size = mark_size(list);
    for (size_t i = 0; i < world.size(); ++i)
      add_marks(list, world.system(i), state.systems[i], overlay, size);
  }
  if (header.viewer.camera) {
    const CameraParams& c = *header.viewer.camera;
    list.camera = DrawCamera{c.eye, c.target, c.up, c.fov * 57.29577951308232};
  }
  char time[48];
  std::snprintf(time, sizeof time, "t = %.3f s", t);
  const std::string& name = header.title.empty() ? header.name : header.title;
  list.caption = name.empty() ? time : name + "   " + time;
  return list;
}

}  // namespace truestep
