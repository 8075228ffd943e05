#include "engine/sinks/picture/draw/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/draw/stroke_font.h"
#include "engine/sinks/picture/geometry.h"

namespace truestep::picture {
namespace {

// Sizes follow the picture's height but stay readable in a small picture.
struct Style {
  explicit Style(const DrawList& list, const Canvas& canvas)
      : capital(std::max(7.0, canvas.height / 54.0)),
        margin(1.6 * capital),
        paper(list.background_bottom),
        ink(ink_over(paper)) {}
  double capital, margin;
  Color paper, ink;
};

void blend(uint8_t* pixel, const Color& c, float share) {
  const float to[3] = {c.r, c.g, c.b};
  for (int i = 0; i < 3; ++i) {
    const float target = 255 * std::clamp(to[i], 0.0f, 1.0f);
    pixel[i] = static_cast<uint8_t>(std::lround(pixel[i] + (target - pixel[i]) * share));
  }
}

// The part of the picture that a line of text may touch.
struct Window {
  int left, top, width, height;
};

void paint(Canvas canvas, const Window& w, const std::vector<float>& coverage, const Color& color,
           float opacity) {
  for (int y = 0; y < w.height; ++y) {
    uint8_t* row = canvas.rgba + 4 * (static_cast<size_t>(w.top + y) * canvas.width + w.left);
    for (int x = 0; x < w.width; ++x) {
      const float share = coverage[static_cast<size_t>(y) * w.width + x];
      if (share > 0) blend(row + 4 * static_cast<size_t>(x), color, share * opacity);
    }
  }
}

// A halo in the background's colour keeps the text readable over anything.
void write(Canvas canvas, const Style& style, std::string_view text, double x, double baseline,
           double capital, const std::optional<Color>& color = {}) {
  const auto inside = [](double at, int most) { return static_cast<int>(std::clamp(at, 0.0, 1.0 * most)); };
  Window w{inside(x - capital, canvas.width), inside(baseline - 2 * capital, canvas.height), 0, 0};
  w.width = inside(x + text_width(text, capital) + 2 * capital, canvas.width) - w.left;
  w.height = inside(baseline + capital, canvas.height) - w.top;
  if (w.width <= 0 || w.height <= 0) return;
  const double stroke = std::max(1.3, capital / 6.5);
  const auto covered = [&](double pen) {
    return text_coverage(text, {x - w.left, baseline - w.top, capital, pen}, w.width, w.height);
  };
  paint(canvas, w, covered(stroke + 0.45 * capital), style.paper, 0.6f);
  paint(canvas, w, covered(stroke), color.value_or(style.ink), 0.92f);
}

// Labels never leave the picture: one at its edge is moved inside.
void draw_label(Canvas canvas, const Style& style, const View& view, const DrawLabel& label) {
  using Side = DrawLabel::Side;
  const Vec3f p = view.units.position(label.at);
  const Vec3 q = Vec3{p.x, p.y, p.z} - view.eye;
  const double depth = -dot(q, view.back);
  if (!(depth > view.near_plane)) return;
  double x = 0.5 * canvas.width + dot(q, view.right) / (depth * view.pixel);
  double y = 0.5 * canvas.height - dot(q, view.above) / (depth * view.pixel);
  if (x < 0 || y < 0 || x > canvas.width || y > canvas.height) return;
  const double capital = 0.85 * style.capital, width = text_width(label.text, capital), gap = 0.8 * capital;
  switch (label.side) {
    case Side::left:
      x -= width + gap, y += 0.5 * capital;
      break;
    case Side::right:
      x += gap, y += 0.5 * capital;
      break;
    case Side::above:
      x -= 0.5 * width, y -= gap;
      break;
    case Side::below:
      x -= 0.5 * width, y += gap + capital;
      break;
    case Side::under:
      x -= 0.5 * width, y += 2.4 * gap + 2 * capital;
      break;
    case Side::corner:
      x -= width, y -= gap;
      break;
  }
  const double edge = 0.6 * capital;
  x = std::clamp(x, edge, std::max(edge, canvas.width - width - edge));
  write(canvas, style, label.text, x, std::clamp(y, capital + edge, canvas.height - edge), capital,
        label.color);
}

void draw_legend(Canvas canvas, const Style& style, const std::vector<LegendRow>& rows) {
  const double line = 1.9 * style.capital;
  double baseline = style.margin + style.capital;
  for (const LegendRow& row : rows) {
    const int top = static_cast<int>(baseline - style.capital), side = static_cast<int>(style.capital);
    const int left = static_cast<int>(style.margin);
    for (int y = std::max(0, top); y < std::min(top + side, canvas.height); ++y) {
      for (int x = left; x < std::min(left + side, canvas.width); ++x)
        blend(canvas.rgba + 4 * (static_cast<size_t>(y) * canvas.width + x), row.color, 1);
    }
    write(canvas, style, row.text, left + 1.8 * style.capital, baseline, 0.9 * style.capital);
    baseline += line;
  }
}

/// An end of a range with three digits of the larger one, below which there is only rounding.
std::string end_of(double x, double largest) {
  if (!(largest > 0) || !std::isfinite(largest)) return x == 0 ? "0" : std::to_string(x);
  const int power = static_cast<int>(std::floor(std::log10(largest) + 1e-9));
  const double digit = std::pow(10.0, power - 2), rounded = std::round(x / digit) * digit;
  if (rounded == 0) return "0";
  std::array<char, 64> text{};
  const bool usual = power >= -3 && power < 6;
  std::snprintf(text.data(), text.size(), usual ? "%.*f" : "%.*g", usual ? std::max(0, 2 - power) : 3,
                rounded);
  std::string out = text.data();
  if (usual && out.find('.') != std::string::npos) {
    out.erase(out.find_last_not_of('0') + 1);
    if (out.back() == '.') out.pop_back();
  }
  return out;
}

void draw_bar(Canvas canvas, const Style& style, const DrawScale& scale) {
  const float low = scale.low, high = scale.high;
  const double small = 0.8 * style.capital;
  const int length = std::min(canvas.width / 4, canvas.height / 2),
            thick = std::max(4, static_cast<int>(0.7 * style.capital));
  const int right = canvas.width - static_cast<int>(style.margin), left = right - length;
  const double text_base = canvas.height - style.margin;
  const int bottom = static_cast<int>(text_base - 1.7 * small), top = bottom - thick;
  if (left < 0 || top < 0) return;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) {
      const bool edge = y == top || y == bottom - 1 || x == left || x == right - 1;
      const Color color =
          map_color(scale.map, (static_cast<float>(x - left) + 0.5f) / static_cast<float>(length));
      blend(canvas.rgba + 4 * (static_cast<size_t>(y) * canvas.width + x), edge ? style.ink : color,
            edge ? 0.6f : 1.0f);
    }
  write(canvas, style, scale.label, left, top - 0.8 * small, small);
  const double largest = std::max(std::abs(low), std::abs(high));
  write(canvas, style, end_of(low, largest), left, text_base, small);
  const std::string most = end_of(high, largest);
  write(canvas, style, most, right - text_width(most, small), text_base, small);
}

}  // namespace

void draw_overlay(const DrawList& list, const View& view, Canvas canvas) {
  const Style style(list, canvas);
  for (const DrawLabel& label : list.labels) draw_label(canvas, style, view, label);
  draw_legend(canvas, style, list.legend);
  if (!list.caption.empty())
    write(canvas, style, list.caption, style.margin, canvas.height - style.margin, style.capital);
  const auto labelled = std::find_if(list.points.begin(), list.points.end(), [](const DrawPoints& set) {
    return has_scalars(set) && !set.scalar_label.empty();
  });
  if (labelled != list.points.end()) {
    const auto [low, high] = scalar_range(*labelled);
    draw_bar(canvas, style, {labelled->scalar_label, labelled->color_map, low, high});
  } else if (list.scale) {
    draw_bar(canvas, style, *list.scale);
  }
}

}  // namespace truestep::picture
