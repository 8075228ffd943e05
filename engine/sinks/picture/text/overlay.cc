#include "engine/sinks/picture/text/overlay.h"

#include <algorithm>
#include <cmath>

#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/text/font.h"
#include "engine/sinks/picture/text/overlay_layout.h"

namespace truestep::picture {
namespace {

constexpr float kPanel = 0.55f;  // opacity of what is behind the caption, the legend and the bar

struct Style {
  explicit Style(const DrawList& list) : paper(list.background_bottom), ink(ink_over(paper)) {}
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

Window inside(Canvas canvas, const Rectangle& r) {
  const auto bound = [](double at, int most) { return static_cast<int>(std::clamp(at, 0.0, 1.0 * most)); };
  Window w{bound(r.left, canvas.width), bound(r.top, canvas.height), 0, 0};
  w.width = bound(r.right, canvas.width) - w.left;
  w.height = bound(r.bottom, canvas.height) - w.top;
  return w;
}

void fill(Canvas canvas, const Rectangle& r, const Color& color, float opacity) {
  const Window w = inside(canvas, r);
  if (w.width <= 0 || w.height <= 0) return;
  paint(canvas, w, std::vector<float>(static_cast<size_t>(w.width) * w.height, 1.0f), color, opacity);
}

// A halo in the background's colour keeps the text readable over anything.
void write(Canvas canvas, const Style& style, const TextLine& line) {
  Rectangle r = line.bounds();
  r = {r.left - line.capital, r.top - line.capital, r.right + line.capital, r.bottom + line.capital};
  const Window w = inside(canvas, r);
  if (w.width <= 0 || w.height <= 0) return;
  const auto covered =
      text_coverage(line.text, {line.x - w.left, line.baseline - w.top, line.capital}, w.width, w.height);
  paint(canvas, w, halo_of(covered, w.width, w.height, 0.45 * line.capital), style.paper, 0.6f);
  paint(canvas, w, covered, line.color.value_or(style.ink), 0.95f);
}

void draw_bar(Canvas canvas, const Style& style, const ColorBar& bar) {
  const Window w = inside(canvas, bar.bar);
  for (int y = w.top; y < w.top + w.height; ++y) {
    for (int x = w.left; x < w.left + w.width; ++x) {
      const bool edge = y == w.top || y == w.top + w.height - 1 || x == w.left || x == w.left + w.width - 1;
      const Color color = map_color(
          bar.scale.map, (static_cast<float>(x - w.left) + 0.5f) / static_cast<float>(std::max(1, w.width)),
          paper_of(style.paper));
      blend(canvas.rgba + 4 * (static_cast<size_t>(y) * canvas.width + x), edge ? style.ink : color,
            edge ? 0.6f : 1.0f);
    }
  }
  for (const TextLine* line : {&bar.label, &bar.low, &bar.high}) write(canvas, style, *line);
}

}  // namespace

void draw_overlay(const DrawList& list, const View& view, Canvas canvas) {
  const Style style(list);
  const OverlayLayout layout = layout_overlay(list, &view, canvas.width, canvas.height);
  for (const TextLine& label : layout.labels) write(canvas, style, label);
  for (const Rectangle& panel : layout.panels) fill(canvas, panel, style.paper, kPanel);
  for (const LegendLine& row : layout.legend) {
    fill(canvas, row.swatch, row.color, 1);
    write(canvas, style, row.name);
  }
  for (const TextLine& line : layout.caption) write(canvas, style, line);
  if (layout.bar) draw_bar(canvas, style, *layout.bar);
}

}  // namespace truestep::picture
