#include "engine/sinks/picture/draw/draw_plot.h"

#include <algorithm>
#include <cmath>

#include "engine/sinks/picture/camera.h"
#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/draw/plot_ticks.h"

namespace truestep {

namespace {

constexpr int kTicks = 5;
constexpr double kRoom = 0.04;       // margin between curves and frame, as a fraction of its side
constexpr double kFill = 0.76;       // of the picture's half; ticks and names are outside
constexpr double kAuthored = 0.8;    // share of a given camera's own frame that matters
constexpr double kAspect = 4.0 / 3;  // of the pictures that the scenes' cameras are made for
constexpr float kFrameShare = 0.85f, kGridShare = 0.1f;

struct Sides {
  double low[3], high[3];
};

std::string named(const PlotAxis& axis) {
  return axis.unit.empty() || axis.unit == "1" ? axis.name : axis.name + " (" + axis.unit + ")";
}

DrawPoints strokes(const DrawList& list, float share, double pixels) {
  DrawPoints out;
  out.color = mixed(list.background_bottom, picture::ink_over(list.background_bottom), share);
  out.line_color = out.color;
  out.line_pixels = pixels;
  out.exact_lines = true;
  return out;
}

void stroke(DrawPoints& set, const Vec3& a, const Vec3& b) {
  const auto first = static_cast<uint32_t>(set.positions.size() / 3);
  for (const Vec3& p : {a, b}) {
    for (const double c : {p.x, p.y, p.z}) set.positions.push_back(static_cast<float>(c));
  }
  set.lines.insert(set.lines.end(), {first, first + 1});
}

}  // namespace

void PlotBox::add(const Vec3& p) {
  if (!std::isfinite(p.x + p.y + p.z)) return;
  low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
  high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
}

void PlotBox::add(const std::vector<float>& positions) {
  for (size_t i = 0; i + 2 < positions.size(); i += 3) {
    const Vec3f p = load3(positions.data(), i / 3);
    add(Vec3{p.x, p.y, p.z});
  }
}

void PlotBox::add_time(std::span<const PlotAxis> axes, double duration) {
  for (size_t k = 0; k < axes.size() && k < 3 && !empty(); ++k) {
    if (axes[k].name != "t" || !std::isfinite(duration)) continue;
    for (const double t : {0.0, duration}) {
      Vec3 p = low;
      (k == 0 ? p.x : k == 1 ? p.y : p.z) = place_of(axes[k], t);
      add(p);
    }
  }
}

void PlotBox::open_up() {
  constexpr double kLeastHeight = 1.0 / 3;  // of the width
  const double missing = kLeastHeight * (high.x - low.x) - (high.y - low.y);
  if (empty() || !(missing > 0)) return;
  low.y -= 0.5 * missing, high.y += 0.5 * missing;
}

void add_axes(DrawList& list, std::span<const PlotAxis> axes, const PlotBox& box) {
  using Side = DrawLabel::Side;
  if (axes.size() < 2 || box.empty()) return;
  Sides s{{box.low.x, box.low.y, box.low.z}, {box.high.x, box.high.y, box.high.z}};
  const bool solid = axes.size() > 2;
  for (int k = 0; k < 3; ++k) {
    const double size = s.high[k] - s.low[k], room = k == 2 && !solid ? 0 : kRoom * (size > 0 ? size : 1);
    s.low[k] -= room, s.high[k] += room;
  }
  const auto& [x0, y0, z0] = s.low;
  const auto& [x1, y1, z1] = s.high;
  const double back = solid ? z0 : 0, front = solid ? z1 : 0;
  // A side much shorter than the others has room for fewer labels.
  const double longest = std::max({x1 - x0, y1 - y0, solid ? z1 - z0 : 0});
  const auto ticks = [&](size_t k) {
    const double share = (s.high[k] - s.low[k]) / longest;
    const int wanted = std::clamp(static_cast<int>(std::lround(1.5 * kTicks * share)), 2, kTicks);
    return ticks_of(axes[k], s.low[k], s.high[k], wanted);
  };
  DrawPoints frame = strokes(list, kFrameShare, 2), grid = strokes(list, kGridShare, 1.5);
  const auto label = [&](const std::string& text, const Vec3& at, Side side) {
    list.labels.push_back({text, at, side, {}});
  };
  for (const auto& [x, text] : ticks(0)) {
    stroke(grid, {x, y0, back}, {x, y1, back});
    if (solid) stroke(grid, {x, y0, z0}, {x, y0, z1});
    label(text, {x, y0, front}, Side::below);
  }
  for (const auto& [y, text] : ticks(1)) {
    stroke(grid, {x0, y, back}, {x1, y, back});
    label(text, {x0, y, back}, Side::left);
  }
  stroke(frame, {x0, y0, back}, {x1, y0, back});
  stroke(frame, {x0, y0, back}, {x0, y1, back});
  label(named(axes[0]), {x1, y0, front}, solid ? Side::under : Side::corner);
  label(named(axes[1]), {x0, y1, back}, Side::above);
  if (solid) {
    for (const auto& [z, text] : ticks(2)) {
      stroke(grid, {x0, y0, z}, {x1, y0, z});
      label(text, {x1, y0, z}, Side::right);
    }
    stroke(frame, {x1, y0, z0}, {x1, y0, z1});
    stroke(frame, {x0, y0, z1}, {x1, y0, z1});
    label(named(axes[2]), {x1, y0, z0}, Side::above);
  }
  for (const double x : {x0, x1}) {
    for (const double y : {y0, y1}) {
      for (const double z : {back, front}) list.framed.push_back({x, y, z});
    }
  }
  list.points.push_back(std::move(grid));
  list.points.push_back(std::move(frame));
  list.fill = kFill;
  list.ground_height.reset();
}

void add_curves(DrawList& list, const DrawPoints& points, std::span<const std::string> names, size_t first) {
  const auto starts_curve = [&](size_t l) {
    return l == 0 || points.lines[2 * l] != points.lines[2 * l - 1];
  };
  for (size_t l = 0, curve = 0; l < points.lines.size() / 2; ++curve) {
    DrawPoints& set = list.points.emplace_back();
    set.color = points.color.value_or(picture::palette(first + curve));
    set.line_pixels = points.line_pixels, set.line_radius = points.line_radius;
    const auto push = [&](uint32_t row) {
      const float* p = &points.positions[3 * row];
      set.positions.insert(set.positions.end(), p, p + 3);
    };
    do {
      if (set.positions.empty()) push(points.lines[2 * l]);
      push(points.lines[2 * l + 1]);
      const auto at = static_cast<uint32_t>(set.positions.size() / 3);
      set.lines.insert(set.lines.end(), {at - 2, at - 1});
    } while (++l < points.lines.size() / 2 && !starts_curve(l));
    if (curve < names.size()) list.legend.push_back({names[curve], *set.color});
  }
}

void frame_as(DrawList& list, const DrawCamera& camera) {
  const Vec3 back = camera.eye - camera.target;
  const double half = kAuthored * norm(back) * std::tan(camera.fov_degrees * 3.14159265358979323846 / 360);
  const Vec3 up = picture::axes_of(camera.up.value_or(list.up)).up, away = normalized(back);
  const Vec3 right = normalized(cross(up, away), picture::axes_of(up).side), above = cross(away, right);
  for (const double u : {-half, half}) {
    for (const double v : {-half, half})
      list.framed.push_back(camera.target + right * (kAspect * u) + above * v);
  }
  list.facing = away;
}

}  // namespace truestep
