#include "engine/sinks/picture/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/geometry.h"
#include "engine/sinks/picture/stroke_font.h"

namespace truestep::picture {
namespace {

constexpr Color kDarkInk{0.17f, 0.21f, 0.28f}, kLightInk{0.88f, 0.91f, 0.95f};

// Sizes follow the picture's height but stay readable in a small one.
struct Style {
  explicit Style(const DrawList& list, const Canvas& canvas)
      : capital(std::max(7.0, canvas.height / 54.0)),
        margin(1.6 * capital),
        paper(list.background_bottom),
        ink(paper.r + paper.g + paper.b > 1.2f ? kDarkInk : kLightInk) {}
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

void paint(Canvas canvas, const std::vector<float>& coverage, const Color& color, float opacity) {
  for (size_t i = 0; i < coverage.size(); ++i)
    if (coverage[i] > 0) blend(canvas.rgba + 4 * i, color, coverage[i] * opacity);
}

// A halo in the background's colour keeps the text readable over anything.
void write(Canvas canvas, const Style& style, std::string_view text, double x, double baseline,
           double capital) {
  const double stroke = std::max(1.3, capital / 6.5);
  paint(canvas,
        text_coverage(text, {x, baseline, capital, stroke + 0.45 * capital}, canvas.width, canvas.height),
        style.paper, 0.6f);
  paint(canvas, text_coverage(text, {x, baseline, capital, stroke}, canvas.width, canvas.height), style.ink,
        0.92f);
}

std::string number(float x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", static_cast<double>(x));
  return text.data();
}

void draw_bar(Canvas canvas, const Style& style, const DrawPoints& set) {
  const auto [low, high] = scalar_range(set);
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
          map_color(set.color_map, (static_cast<float>(x - left) + 0.5f) / static_cast<float>(length));
      blend(canvas.rgba + 4 * (static_cast<size_t>(y) * canvas.width + x), edge ? style.ink : color,
            edge ? 0.6f : 1.0f);
    }
  write(canvas, style, set.scalar_label, left, top - 0.8 * small, small);
  write(canvas, style, number(low), left, text_base, small);
  const std::string most = number(high);
  write(canvas, style, most, right - text_width(most, small), text_base, small);
}

}  // namespace

void draw_overlay(const DrawList& list, Canvas canvas) {
  const Style style(list, canvas);
  if (!list.caption.empty())
    write(canvas, style, list.caption, style.margin, canvas.height - style.margin, style.capital);
  const auto labelled = std::find_if(list.points.begin(), list.points.end(), [](const DrawPoints& set) {
    return !(set.scalar.empty() && set.line_scalar.empty()) && !set.scalar_label.empty();
  });
  if (labelled != list.points.end()) draw_bar(canvas, style, *labelled);
}

}  // namespace truestep::picture
