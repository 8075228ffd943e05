#include "engine/sinks/picture/draw/draw_grid.h"

#include <algorithm>
#include <cmath>

#include "engine/math/even_streamlines.h"
#include "engine/math/iso_lines.h"
#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/draw/draw_plot.h"
#include "engine/sinks/picture/draw/draw_scale.h"
#include "engine/sinks/picture/geometry.h"

namespace truestep {
namespace {

constexpr size_t kSlices = 9;        // of a volume
constexpr double kCurveShare = 0.3;  // a curve's height as a fraction of its length
constexpr size_t kMostArrows = 28;   // along a side

double component(const Vec3& v, size_t axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}
Vec3 unit(size_t axis) {
  return {axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
}

// A grid of cells fills its box: half a cell beyond the outermost centres there is a vertex more, which has
// their value, as for probes (core/lattice.h). A grid of nodes has its vertices at the nodes.
bool has_rim(const Lattice& l, size_t axis) {
  return l.centring == Lattice::Centring::cells && l.counts[axis] > 1;
}
/// Lattice units from the outermost row to the grid's edge.
double margin(const Lattice& l, size_t axis) {
  return has_rim(l, axis) ? 0.5 : 0;
}
size_t vertices(const Lattice& l, size_t axis) {
  return l.counts[axis] + (has_rim(l, axis) ? 2 : 0);
}
/// The row along the axis that has the value of a vertex.
size_t row_of_vertex(const Lattice& l, size_t axis, size_t k) {
  return has_rim(l, axis) ? std::clamp<size_t>(k, 1, l.counts[axis]) - 1 : k;
}
/// Lattice coordinate of a vertex, or of a point between two.
double place_of_vertex(const Lattice& l, size_t axis, double k) {
  if (!has_rim(l, axis)) return k;
  const double inside = std::clamp(k, 1.0, static_cast<double>(l.counts[axis]));
  return inside - 1 + 0.5 * (k - inside);
}

/// A plane of rows: two directions of a lattice and a position along the third.
struct Plane {
  const Lattice& lattice;
  size_t u, v, w;    ///< axes; w is perpendicular to the plane
  size_t layer = 0;  ///< index along w
  size_t nu() const { return lattice.counts[u]; }
  size_t nv() const { return lattice.counts[v]; }
  size_t row(size_t i, size_t j) const {
    const size_t step[3] = {1, lattice.counts[0], size_t{lattice.counts[0]} * lattice.counts[1]};
    return i * step[u] + j * step[v] + layer * step[w];
  }
  /// m, of lattice coordinates in the plane.
  Vec3 at(double i, double j) const {
    const auto along = [&](size_t axis, double k) {
      return unit(axis) * (k * component(lattice.spacing, axis));
    };
    return lattice.origin + along(u, i) + along(v, j) + along(w, static_cast<double>(layer));
  }
  /// m, of a point between vertices.
  Vec3 at_vertex(double i, double j) const {
    return at(place_of_vertex(lattice, u, i), place_of_vertex(lattice, v, j));
  }
  /// f(i, j, row) of every vertex, u fastest.
  template <class F>
  void for_vertices(F&& f) const {
    for (size_t j = 0; j < vertices(lattice, v); ++j) {
      for (size_t i = 0; i < vertices(lattice, u); ++i)
        f(i, j, row(row_of_vertex(lattice, u, i), row_of_vertex(lattice, v, j)));
    }
  }
};

/// The axes that a lattice has, then those that it lacks.
std::array<size_t, 3> axes_of(const Lattice& l) {
  std::array<size_t, 3> axes{0, 1, 2};
  std::stable_partition(axes.begin(), axes.end(), [&](size_t a) { return l.counts[a] > 1; });
  return axes;
}

struct Shown {
  std::vector<float> values;  ///< rows x width
  std::vector<float> size;    ///< rows
  uint32_t width = 1;
  DrawPoints style;  ///< colours, range, label
};

void push(std::vector<float>& out, const Vec3& p) {
  out.insert(out.end(), {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
}

Shown shown_of(const PartInfo& part, size_t field, const FrameValues& values, const ViewerParams& viewer) {
  Shown s;
  s.values = values.floats();
  s.width = values.width();
  s.size.resize(values.rows());
  for (size_t r = 0; r < s.size.size(); ++r) {
    double sum = 0;
    for (uint32_t c = 0; c < s.width; ++c) sum += std::pow(s.values[r * s.width + c], 2);
    s.size[r] = s.width == 1 ? s.values[r] : static_cast<float>(std::sqrt(sum));
  }
  apply_scale(s.style, viewer, part.fields[field], part.fields[field].name);
  s.style.scalar = s.size;
  const auto [low, high] = picture::scalar_range(s.style);
  s.style.scalar.clear();
  s.style.scalar_min = low, s.style.scalar_max = high;
  return s;
}

/// Line segments with a visible radius.
DrawPoints strokes(const Color& color, double radius) {
  DrawPoints out;
  out.color = color;
  out.line_color = color;
  out.line_radius = static_cast<float>(radius);
  return out;
}
void add_stroke(DrawPoints& out, const Vec3& a, const Vec3& b) {
  const auto first = static_cast<uint32_t>(out.positions.size() / 3);
  push(out.positions, a), push(out.positions, b);
  out.lines.insert(out.lines.end(), {first, first + 1});
}

DrawPoints surface(const Plane& p, const Shown& s, double height) {
  DrawPoints out = s.style;
  p.for_vertices([&](size_t i, size_t j, size_t row) {
    const float value = s.size[row];
    const Vec3 flat = p.at_vertex(static_cast<double>(i), static_cast<double>(j));
    push(out.positions, flat + unit(p.w) * (height * value));
    out.scalar.push_back(value);
  });
  const auto n = static_cast<uint32_t>(vertices(p.lattice, p.u));
  for (uint32_t j = 0; j + 1 < vertices(p.lattice, p.v); ++j) {
    for (uint32_t i = 0; i + 1 < n; ++i) {
      const uint32_t a = i + n * j;
      out.triangles.insert(out.triangles.end(), {a, a + 1, a + n + 1, a, a + n + 1, a + n});
    }
  }
  out.surface = height == 0 ? DrawPoints::Surface::plain : DrawPoints::Surface::lit;
  return out;
}

/// m; thickness of lines on a plane.
double line_size(const Plane& p) {
  const Lattice& l = p.lattice;
  const auto last = [&](size_t axis) { return static_cast<double>(vertices(l, axis) - 1); };
  return 0.0018 * norm(p.at_vertex(last(p.u), last(p.v)) - p.at_vertex(0, 0));
}

/// Lines over the plane's colours.
DrawPoints ink_strokes(const DrawList& list, const Plane& p, const Shown& s) {
  DrawPoints out =
      strokes(picture::ink_on(s.style.color_map, picture::paper_of(list.background_bottom)), line_size(p));
  out.exact_lines = true;
  return out;
}

void add_contours(DrawList& list, const Plane& p, const Shown& s, const ViewerParams& viewer) {
  std::vector<float> flat;
  p.for_vertices([&](size_t, size_t, size_t row) { flat.push_back(s.size[row]); });
  DrawPoints lines = ink_strokes(list, p, s);
  const double low = *s.style.scalar_min, high = *s.style.scalar_max, height = viewer.height.value_or(0);
  std::vector<IsoSegment> segments;
  for (int64_t k = 1; k <= viewer.contours; ++k) {
    const double level =
        low + (high - low) * static_cast<double>(k) / static_cast<double>(viewer.contours + 1);
    segments.clear();
    append_iso_lines(flat, vertices(p.lattice, p.u), vertices(p.lattice, p.v), level, segments);
    const Vec3 up = unit(p.w) * (height * level);
    for (const auto& [a, b] : segments)
      add_stroke(lines, p.at_vertex(a[0], a[1]) + up, p.at_vertex(b[0], b[1]) + up);
  }
  if (!lines.lines.empty()) list.points.push_back(std::move(lines));
}

float along(const Plane& p, const Shown& s, size_t row, size_t axis) {
  // Fields of two components lie in the lattice's own plane.
  const size_t c = s.width == 2 ? (axis == p.u ? 0 : 1) : axis;
  return s.values[row * s.width + c];
}

void add_arrows(DrawList& list, const Plane& p, const Shown& s) {
  const size_t stride = std::max<size_t>(
      {1, (p.nu() + kMostArrows - 1) / kMostArrows, (p.nv() + kMostArrows - 1) / kMostArrows});
  const double cell = static_cast<double>(stride) *
                      std::min(component(p.lattice.spacing, p.u), component(p.lattice.spacing, p.v));
  const double most = *s.style.scalar_max;
  if (!(most > 0)) return;
  DrawPoints lines = ink_strokes(list, p, s);
  for (size_t j = stride / 2; j < p.nv(); j += stride) {
    for (size_t i = stride / 2; i < p.nu(); i += stride) {
      const size_t r = p.row(i, j);
      const Vec3 d =
          (unit(p.u) * along(p, s, r, p.u) + unit(p.v) * along(p, s, r, p.v)) * (0.9 * cell / most);
      if (!(norm(d) > 0.02 * cell)) continue;
      const Vec3 a = p.at(static_cast<double>(i), static_cast<double>(j)), b = a + d;
      const Vec3 side = cross(unit(p.w), d) * 0.18;
      add_stroke(lines, a, b);
      for (const Vec3& barb : {side, -side}) add_stroke(lines, b, b - d * 0.3 + barb);
    }
  }
  if (!lines.lines.empty()) list.points.push_back(std::move(lines));
}

void add_streamlines(DrawList& list, const Plane& p, const Shown& s, int64_t count) {
  std::vector<float> u, v;
  for (size_t j = 0; j < p.nv(); ++j) {
    for (size_t i = 0; i < p.nu(); ++i) {
      const size_t r = p.row(i, j);
      u.push_back(along(p, s, r, p.u) / static_cast<float>(component(p.lattice.spacing, p.u)));
      v.push_back(along(p, s, r, p.v) / static_cast<float>(component(p.lattice.spacing, p.v)));
    }
  }
  const PlaneField field{u, v, p.nu(), p.nv(), margin(p.lattice, p.u)};
  DrawPoints lines = ink_strokes(list, p, s);
  for (const auto& path : even_streamlines(field, static_cast<size_t>(count))) {
    for (size_t i = 0; i + 1 < path.size(); ++i)
      add_stroke(lines, p.at(path[i][0], path[i][1]), p.at(path[i + 1][0], path[i + 1][1]));
  }
  if (!lines.lines.empty()) list.points.push_back(std::move(lines));
}

void add_curve(DrawList& list, const Lattice& l, size_t axis, const Shown& s, const ViewerParams& viewer) {
  const size_t up = axis == 1 ? 0 : 1;
  const double edge = margin(l, axis),
               length = component(l.spacing, axis) * (static_cast<double>(l.counts[axis] - 1) + 2 * edge);
  const Vec3 start = l.origin - unit(axis) * (edge * component(l.spacing, axis));
  const double low = *s.style.scalar_min, high = *s.style.scalar_max;
  const double reach = std::max(std::abs(low), std::abs(high));
  const double height = viewer.height.value_or(reach > 0 ? kCurveShare * length / reach : 1);
  DrawPoints curve = s.style, base = strokes({0.45f, 0.47f, 0.5f}, 0.0015 * length);
  const auto value = [&](size_t i) { return s.size[row_of_vertex(l, axis, i)]; };
  for (size_t i = 0; i < vertices(l, axis); ++i) {
    const double place = place_of_vertex(l, axis, static_cast<double>(i));
    const Vec3 at = l.origin + unit(axis) * (place * component(l.spacing, axis));
    push(curve.positions, at + unit(up) * (height * value(i)));
    if (i == 0) continue;
    curve.lines.insert(curve.lines.end(), {static_cast<uint32_t>(i - 1), static_cast<uint32_t>(i)});
    curve.line_scalar.push_back(0.5f * (value(i - 1) + value(i)));
  }
  curve.line_radius = static_cast<float>(0.004 * length);
  add_stroke(base, start, start + unit(axis) * length);
  if (axis < 2) {
    PlotAxis axes[2];
    axes[axis].name = std::string(1, axis == 0 ? 'x' : 'y'), axes[axis].unit = std::string(1, 'm');
    axes[up].name = s.style.scalar_label, axes[up].slope = height, axes[up].offset = component(l.origin, up);
    PlotBox box;
    for (const double end : {low, high}) box.add(start + unit(up) * (height * end));
    box.add(start + unit(axis) * length);
    add_axes(list, axes, box);
    curve.scalar_label.clear();  // the axis says it
  }
  list.points.push_back(std::move(curve));
  list.points.push_back(std::move(base));
}

size_t layer_of(const Lattice& l, size_t axis, const std::optional<double>& at) {
  const double last = static_cast<double>(l.counts[axis]) - 1;
  if (!at) return static_cast<size_t>(last / 2);
  const double k = (*at - component(l.origin, axis)) / component(l.spacing, axis);
  return static_cast<size_t>(std::lround(std::clamp(k, 0.0, last)));
}

void add_plane(DrawList& list, const Plane& p, const Shown& s, const ViewerParams& viewer) {
  list.points.push_back(surface(p, s, viewer.height.value_or(0)));
  if (viewer.contours > 0) add_contours(list, p, s, viewer);
  if (s.width > 1 && viewer.streamlines > 0) {
    add_streamlines(list, p, s, viewer.streamlines);
  } else if (s.width > 1) {
    add_arrows(list, p, s);
  }
}

}  // namespace

void add_grid(DrawList& list, const PartInfo& part, size_t field, const FrameValues& values,
              const ViewerParams& viewer) {
  const Lattice& l = part.lattice;
  if (values.rows() != l.rows() || l.dimensions() == 0) return;
  const Shown s = shown_of(part, field, values, viewer);
  const auto axes = axes_of(l);
  if (l.dimensions() == 1) return add_curve(list, l, axes[0], s, viewer);
  if (l.dimensions() == 2) return add_plane(list, {l, axes[0], axes[1], axes[2]}, s, viewer);
  const auto cut = static_cast<size_t>(viewer.slice ? viewer.slice->axis : SliceParams::Axis::z);
  Plane p{l, cut == 0 ? 1u : 0u, cut == 2 ? 1u : 2u, cut};
  if (viewer.slice) {
    p.layer = layer_of(l, cut, viewer.slice->at);
    return add_plane(list, p, s, viewer);
  }
  const size_t slices = std::min<size_t>(kSlices, l.counts[cut]);
  for (size_t k = 0; k < slices; ++k) {
    p.layer = slices > 1 ? k * (l.counts[cut] - 1) / (slices - 1) : 0;
    list.points.push_back(surface(p, s, 0));
    list.points.back().surface = DrawPoints::Surface::translucent;
  }
}

std::optional<Vec3> facing_side(const PartInfo& part, const ViewerParams& viewer) {
  const auto axes = axes_of(part.lattice);
  if (part.lattice.dimensions() == 1) return axes[0] == 2 ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
  if (viewer.height && *viewer.height != 0) return std::nullopt;
  if (part.lattice.dimensions() == 2) return unit(axes[2]);
  if (viewer.slice) return unit(static_cast<size_t>(viewer.slice->axis));
  return std::nullopt;
}

}  // namespace truestep
