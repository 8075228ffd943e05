#include "engine/sinks/picture/draw/draw_world.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/errors.h"
#include "engine/math/quaternion.h"
#include "engine/scene/params/params.h"
#include "engine/scene/params/params_text.h"
#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/draw/draw_elements.h"
#include "engine/sinks/picture/draw/draw_grid.h"
#include "engine/sinks/picture/draw/draw_liquid.h"
#include "engine/sinks/picture/draw/draw_names.h"
#include "engine/sinks/picture/draw/draw_plot.h"
#include "engine/sinks/picture/draw/draw_scale.h"
#include "engine/sinks/picture/draw/draw_strings.h"
#include "engine/sinks/picture/draw/draw_systems.h"
#include "engine/sinks/picture/geometry.h"

namespace truestep {

namespace {

constexpr double kLinePixels = 3.5;     // of ropes, rods and curves
constexpr double kMarkPixels = 9;       // of the points of a net without a size
constexpr size_t kNet = 1500;           // from this many lines on they form a net and are drawn as thin as
                                        // possible
constexpr size_t kMarked = 128;         // points
constexpr double kGridFill = 0.8;       // for a field's picture: caption and colour bar are below it
constexpr double kMarkShare = 0.08;     // longest line of a mark, of the size of what is drawn
constexpr double kWideContainer = 2.5;  // a container this many times wider than what is in it is not framed
constexpr double kFlatFov = 12;         // degrees: a planar scene shows its faces, not its sides

/// Values of lines or triangles colour those that are drawn: `rows` of them; unless the points have values.
std::vector<float> take_values(const World& world, const Frame& frame, const FieldPlace& at,
                               const std::vector<uint32_t>& rows, const ViewerParams& viewer,
                               DrawPoints& points) {
  const FieldInfo& field = world.parts()[at.part].info().fields[at.field];
  apply_scale(points, viewer, field, viewer.color_by);
  return picked(element_values(world, frame, at), rows);
}

DrawPoints points_of(const World& world, const Frame& frame, size_t p, const ViewerParams& viewer) {
  const std::string& color_by = viewer.color_by;
  const PartInfo& info = world.parts()[p].info();
  DrawPoints points;
  points.positions = FrameValues(frame, p, info.find(Meaning::position)).floats();
  if (const auto f = color_field(info, color_by)) {
    points.scalar = magnitudes(FrameValues(frame, p, f).floats(), info.fields[*f].width);
    if (points.scalar.size() * 3 == points.positions.size()) {
      apply_scale(points, viewer, info.fields[*f], color_by);
    } else {
      points.scalar.clear();
    }
  }
  const PartDrawing& topology = frame.constant->parts[p];
  points.radius = static_cast<float>(topology.point_radius);
  points.line_radius = points.radius / 4;
  const auto n = static_cast<uint32_t>(points.positions.size() / 3);
  const auto valued_lines = element_field(world, p, PartInfo::Elements::lines, color_by);
  const auto valued_triangles = element_field(world, p, PartInfo::Elements::triangles, color_by);
  std::vector<uint32_t> lines, elements;
  for (size_t i = 0; i < topology.lines.size(); ++i) {
    const auto& l = topology.lines[i];
    const bool brace = i < topology.line_kinds.size() && topology.line_kinds[i] != LineKind::structural;
    if (l[0] >= n || l[1] >= n || (brace && !topology.triangles.empty())) continue;
    lines.push_back(static_cast<uint32_t>(i));
    points.lines.insert(points.lines.end(), {l[0], l[1]});
    points.line_kinds.push_back(i < topology.line_kinds.size() ? static_cast<uint8_t>(topology.line_kinds[i])
                                                               : 0);
  }
  for (size_t i = 0; i < topology.triangles.size(); ++i) {
    const auto& t = topology.triangles[i];
    if (t[0] >= n || t[1] >= n || t[2] >= n) continue;
    points.triangles.insert(points.triangles.end(), {t[0], t[1], t[2]});
    const bool named = i < topology.triangle_elements.size();
    elements.push_back(named ? topology.triangle_elements[i] : static_cast<uint32_t>(i));
  }
  const bool bare = points.triangles.empty() && points.radius == 0;
  if (valued_lines && (bare || points.scalar.empty()))
    points.line_scalar = take_values(world, frame, *valued_lines, lines, viewer, points);
  if (valued_triangles && points.scalar.empty())
    points.triangle_scalar = take_values(world, frame, *valued_triangles, elements, viewer, points);
  // Springs under a surface would only be clutter, unless their colours are what is asked for.
  if (!points.triangles.empty() && points.line_scalar.empty())
    points.lines.clear(), points.line_kinds.clear();
  if (topology.color) {
    const auto& c = *topology.color;
    points.color = Color{static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
  }
  const bool net = points.lines.size() / 2 > kNet;
  points.line_pixels = net ? 0 : kLinePixels;
  points.exact_lines = net;  // together they are as visible as a surface: hair stays brown on dark paper
  if (!net && points.radius == 0 && n <= kMarked && points.triangles.empty() && topology.plot.empty())
    points.point_pixels = topology.visuals.empty() ? kMarkPixels : 0;
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

// Names of systems in readable form.
std::string spaced(std::string id) {
  std::replace(id.begin(), id.end(), '_', ' ');
  return id;
}

// Pictures are upright: up is the axis that the scene's camera names, if not its default y, else the one
// opposite to gravity; y when there is no gravity or it is slanted.
Vec3 up_of(const SceneHeader& header) {
  const auto& camera = header.viewer.camera;
  const Vec3 own = camera ? normalized(camera->up, {0, 1, 0}) : Vec3{0, 1, 0};
  const Vec3 up = std::abs(own.y) < 0.9 ? own : normalized(-header.gravity, {0, 1, 0});
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 0, 1}}) {
    if (std::abs(dot(up, axis)) > 0.9) return axis * (dot(up, axis) > 0 ? 1.0 : -1.0);
  }
  return {0, 1, 0};
}

// The viewer assigns its palette to the parts in the same order.
std::vector<size_t> palette_places(const World& world) {
  std::vector<size_t> out;
  size_t next = 0;
  for (size_t p = 0; p < world.parts().size(); ++p) {
    out.push_back(next);
    next += world.parts()[p].info().kind != PartInfo::Kind::values;
  }
  return out;
}

// Systems that their colour tells apart.
/// The colour that the scene gives to something that a part's system shows.
std::optional<Color> own_color(const World& world, const Frame& frame, size_t part) {
  const auto of = [](const std::array<double, 3>& c) {
    return Color{static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
  };
  for (size_t q = 0; q < world.parts().size(); ++q) {
    if (world.parts()[q].system != world.parts()[part].system) continue;
    const PartDrawing& drawing = frame.constant->parts[q];
    if (drawing.color) return of(*drawing.color);
    for (const Visual& visual : drawing.visuals) {
      if (visual.color) return of(*visual.color);
    }
  }
  return std::nullopt;
}

void add_legend(DrawList& list, const std::vector<LegendRow>& systems) {
  if (systems.size() > 1) list.legend.insert(list.legend.end(), systems.begin(), systems.end());
}

bool lies_in_plane(const World& world, const Frame& frame) {
  for (size_t p = 0; p < world.parts().size(); ++p) {
    const auto kind = world.parts()[p].info().kind;
    if (kind == PartInfo::Kind::grid) return false;
    if (kind == PartInfo::Kind::points && frame.constant->parts[p].space != PartDrawing::Space::plane)
      return false;
  }
  return world.parts().size() > 0;
}

// Viewed from afar through a long lens: the same part of the plane, and hardly any of the sides.
void flatten(DrawList& list) {
  list.fov_degrees = kFlatFov;
  list.ground_height.reset();
  if (!list.facing) list.facing = Vec3{0, 0, 1};
  if (!list.camera) return;
  DrawCamera& c = *list.camera;
  const double half = 3.14159265358979323846 / 360;
  const double farther = std::tan(c.fov_degrees * half) / std::tan(kFlatFov * half);
  if (farther > 1) c.eye = c.target + (c.eye - c.target) * farther, c.fov_degrees = kFlatFov;
}

// Where a camera looks from; the front is the side that z points to, or x where z is up.
Vec3 side_of(PictureLook::View view, const Vec3& up) {
  const Vec3 front = std::abs(up.z) > 0.9 ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
  if (view == PictureLook::View::front) return front;
  return view == PictureLook::View::top ? up : cross(up, front);
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

/// m, across what is drawn; 0.2 / kMarkShare if that is nothing.
double size_of(const DrawList& list) {
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
  return std::isfinite(size) && size > 0 ? size : 0.2 / kMarkShare;
}

// The ground lies below everything drawn.
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

void require_color(const World& world, const std::string& color_by) {
  if (color_by.empty()) return;
  const std::vector<std::string> names = world.parts().color_names();
  if (std::find(names.begin(), names.end(), color_by) != names.end()) return;
  throw Error("bad_request", "nothing that is drawn in this scene has this field",
              {"?color_by", "unknown_field", "nothing that is drawn in this scene has this field",
               '"' + color_by.substr(0, 64) + '"', join_names(names), nearest_name(color_by, names), ""});
}

FrameRequest picture_request(const World& world, const PictureLook& look) {
  const std::string& color_by = look.color_by ? *look.color_by : world.scene().header.viewer.color_by;
  FrameRequest request;
  request.wishes = Wish::constant | Wish::obstacles | look.marks;
  for (size_t p = 0; p < world.parts().size(); ++p) {
    const PartInfo& info = world.parts()[p].info();
    const auto take = [&](std::optional<size_t> f) {
      if (!f) return;
      request.fields.push_back({static_cast<uint32_t>(p), static_cast<uint32_t>(*f), info.fields[*f].type});
    };
    for (const Meaning m : {Meaning::position, Meaning::orientation, Meaning::asleep}) take(info.find(m));
    const auto colors = color_field(info, color_by);
    take(info.kind == PartInfo::Kind::grid && !colors ? std::optional<size_t>(0) : colors);
  }
  for (const FieldPlace& at : element_fields(world, color_by)) {
    const PartInfo& info = world.parts()[at.part].info();
    request.fields.push_back(
        {static_cast<uint32_t>(at.part), static_cast<uint32_t>(at.field), info.fields[at.field].type});
    if (info.elements == PartInfo::Elements::joints) request.wishes = request.wishes | Wish::joints;
  }
  std::sort(request.fields.begin(), request.fields.end());
  request.fields.erase(std::unique(request.fields.begin(), request.fields.end()), request.fields.end());
  return request;
}

DrawList draw_list_of(const World& world, const Frame& frame, const PictureLook& look) {
  DrawList list;
  const SceneHeader& header = world.scene().header;
  // A range and a legend belong to the field named by the scene.
  ViewerParams viewer = header.viewer;
  if (look.color_by && *look.color_by != viewer.color_by)
    viewer.color_by = *look.color_by, viewer.range.clear(), viewer.legend.clear(), viewer.names.clear(),
    viewer.color_map = ColorMap::automatic;
  if (viewer.range.empty()) viewer.range = common_range(world, frame, viewer);
  list.up = up_of(header);
  if (look.theme == PictureLook::Theme::dark)
    list.background_top = {0.09f, 0.105f, 0.13f}, list.background_bottom = {0.145f, 0.165f, 0.20f};
  bool has_plane = false;
  PlotBox plot;
  std::vector<PlotAxis> axes;
  std::vector<LegendRow> systems;
  std::vector<NamedSystem> colored_systems;
  const std::vector<size_t> places = palette_places(world);
  for (size_t p = 0; p < world.parts().size(); ++p) {
    const PartInfo& info = world.parts()[p].info();
    if (info.kind != PartInfo::Kind::points) continue;
    DrawPoints points = points_of(world, frame, p, viewer);
    const size_t before = list.shapes.size();
    const auto rows = [&](Meaning m) { return FrameValues(frame, p, info.find(m)); };
    add_bodies(list, frame.constant->parts[p],
               {rows(Meaning::position), rows(Meaning::orientation), rows(Meaning::asleep)}, points,
               places[p]);
    const PartDrawing& drawing = frame.constant->parts[p];
    const bool main = world.parts()[p].index == 0;
    if (const auto color = bodies_color(drawing, places[p]); main && color && points.scalar.empty())
      systems.push_back({spaced(world.parts()[p].id), *color});
    // Rows that only carry bodies are not framed either; coloured ones provide the colour bar.
    const bool only_bodies = list.shapes.size() > before && points.radius == 0 && points.lines.empty() &&
                             points.triangles.empty() && points.scalar.empty();
    if (points.positions.empty() || only_bodies) continue;
    if (!drawing.plot.empty()) {
      plot.add(points.positions);
      if (axes.empty()) axes = drawing.plot;
    }
    const bool colored = picture::has_scalars(points);
    if (!drawing.plot.empty() && !colored && !points.lines.empty()) {
      add_curves(list, points, drawing.curves, places[p]);
      continue;
    }
    if (!points.color) points.color = picture::palette(places[p]);
    if (viewer.liquid == Liquid::surface && list.shapes.size() == before) wrap_liquid(points, drawing.space);
    // Rows drawn by other shapes show no colour of their own.
    const bool visible = points.radius > 0 || !points.lines.empty() || !points.triangles.empty();
    if (main && visible && !colored && list.shapes.size() == before && drawing.plot.empty())
      systems.push_back({spaced(world.parts()[p].id), own_color(world, frame, p).value_or(*points.color)});
    if (const auto place = name_place(points, list.up); main && visible && colored && place)
      colored_systems.push_back({spaced(world.parts()[p].id), *place});
    if (look.trails)
      look.trails->add_to(list, p, frame, points.positions, colored ? std::nullopt : points.color);
    list.points.push_back(std::move(points));
  }
  add_strings(list, world, frame);
  add_legend(list, systems);
  add_kinds_legend(list);
  bool grids_alone = list.points.empty() && list.shapes.empty() && frame.moving.obstacles.empty();
  for (size_t p = 0; p < world.parts().size(); ++p) {
    const PartInfo& info = world.parts()[p].info();
    if (info.kind != PartInfo::Kind::grid) continue;
    const size_t field = color_field(info, viewer.color_by).value_or(0);
    add_grid(list, info, field, FrameValues(frame, p, field), viewer);
    if (grids_alone) list.facing = facing_side(info, viewer);
  }
  grids_alone = grids_alone && !list.points.empty();
  if (grids_alone) list.fill = std::min(list.fill, kGridFill);
  const double seen = list.points.empty() && list.shapes.empty() ? HUGE_VAL : size_of(list);
  for (const DrawnShape& s : frame.moving.obstacles) {
    list.shapes.push_back(shape_of(s));
    // A wide container would make what lives in it small.
    if (s.container && 2 * norm(s.size) > kWideContainer * seen)
      list.shapes.back().framing = DrawShape::Framing::ignored;
    has_plane |= s.kind == DrawnShape::Kind::plane;
  }
  if (const double low = lowest_point(list); !has_plane && !grids_alone && std::isfinite(low))
    list.ground_height = low - 0.05;
  add_marks(list, frame.moving, kMarkShare * size_of(list), joint_colors(list, world, frame, viewer));
  if (look.view != PictureLook::View::scene) {
    if (look.view != PictureLook::View::all) list.facing = side_of(look.view, list.up);
  } else if (viewer.camera) {
    const CameraParams& c = *viewer.camera;
    list.camera = DrawCamera{c.eye, c.target, c.up, c.fov * 57.29577951308232};
  }
  if (!axes.empty()) {
    plot.add_time(axes, header.time.duration);
    plot.open_up();
    add_axes(list, axes, plot);
  }
  if (lies_in_plane(world, frame)) flatten(list);
  // Names are outside a plot's frame: an automatic camera leaves room for them.
  if (!list.labels.empty() && list.camera) frame_as(list, *std::exchange(list.camera, std::nullopt));
  if (viewer.labels) add_names(list, colored_systems);
  if (viewer.probe_labels) add_probe_labels(list, world, frame);
  const std::string time = time_text(frame.time, header.time.duration);
  const std::string& name = header.title.empty() ? header.name : header.title;
  list.caption = name.empty() ? time : name + "   " + time;
  return list;
}

}  // namespace truestep
