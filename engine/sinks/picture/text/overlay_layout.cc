#include "engine/sinks/picture/text/overlay_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "engine/sinks/picture/geometry.h"
#include "engine/sinks/picture/text/font.h"

namespace truestep::picture {
namespace {

constexpr double kLeastCapital = 6;  // pixels
constexpr double kDescent = 0.35;    // of letters below the line, in capitals

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

Rectangle around(const Rectangle& a, const Rectangle& b) {
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
          std::max(a.bottom, b.bottom)};
}

Rectangle widened(const Rectangle& r, double by) {
  return {r.left - by, r.top - by, r.right + by, r.bottom + by};
}

/// Cut at a character's end, with dots, to be no wider than `most`.
std::string shortened(std::string text, double capital, double most) {
  if (text_width(text, capital) <= most) return text;
  while (!text.empty() && text_width(text + "…", capital) > most) {
    while (!text.empty() && (text.back() & 0xC0) == 0x80) text.pop_back();
    if (!text.empty()) text.pop_back();
  }
  return text + "…";
}

class Layout {
 public:
  Layout(const DrawList& list, int width, int height)
      : list_(list),
        width_(width),
        height_(height),
        capital_(std::max(7.0, std::min(height / 54.0, width / 60.0))),
        margin_(1.6 * capital_) {}

  OverlayLayout make(const View* view) {
    place_bar();
    place_caption();
    place_legend();
    if (view) place_labels(*view);
    return std::move(out_);
  }

 private:
  void add_panel(const Rectangle& r) { out_.panels.push_back(widened(r, 0.6 * capital_)); }

  void place_bar() {
    const auto scale = scale_of(list_);
    if (!scale) return;
    const double small = 0.85 * capital_, length = std::min(width_ / 4, height_ / 2);
    const double right = width_ - margin_, left = right - length, base = height_ - margin_;
    const double bottom = base - 1.7 * small, top = bottom - std::max(4.0, 0.7 * capital_);
    if (left < 0 || top < 0) return;
    const double largest = std::max(std::abs(scale->low), std::abs(scale->high));
    const std::string most = end_of(scale->high, largest);
    ColorBar bar{*scale, {left, top, right, bottom}, {}, {}, {}};
    const std::string label = shortened(scale->label, small, std::max<double>(length, 0.45 * width_));
    bar.label = {label, std::min(left, right - text_width(label, small)), top - 0.8 * small, small};
    bar.low = {end_of(scale->low, largest), left, base, small};
    bar.high = {most, right - text_width(most, small), base, small};
    add_panel(around(around(bar.bar, bar.label.bounds()), around(bar.low.bounds(), bar.high.bounds())));
    out_.bar = std::move(bar);
  }

  // In one line; where there is no room beside the bar, the title above the time, in smaller letters if need
  // be.
  void place_caption() {
    if (list_.caption.empty()) return;
    const double edge = out_.bar ? out_.panels[0].left - 1.2 * capital_ : width_ - margin_;
    const double room = std::max(edge - margin_, 4 * capital_), base = height_ - margin_;
    const size_t gap = list_.caption.rfind("   ");
    std::vector<std::string> lines{list_.caption};
    if (text_width(list_.caption, capital_) > room && gap != std::string::npos)
      lines = {list_.caption.substr(0, gap), list_.caption.substr(gap + 3)};
    double capital = capital_;
    for (const std::string& line : lines) {
      const double w = text_width(line, capital);
      if (w > room) capital = std::max(kLeastCapital, capital * room / w);
    }
    double baseline = base - 1.9 * capital * static_cast<double>(lines.size() - 1);
    Rectangle all{1e9, 1e9, -1e9, -1e9};
    for (const std::string& line : lines) {
      out_.caption.push_back({shortened(line, capital, room), margin_, baseline, capital});
      all = around(all, out_.caption.back().bounds());
      baseline += 1.9 * capital;
    }
    add_panel(all);
  }

  // In as many columns as the height above the caption and the bar asks for; rows without room are left out.
  void place_legend() {
    const double line = 1.9 * capital_, small = 0.9 * capital_;
    double floor = height_;
    for (const Rectangle& panel : out_.panels) floor = std::min(floor, panel.top - capital_);
    const auto rows = static_cast<size_t>(std::max(0.0, (floor - margin_) / line));
    double left = margin_, next = margin_;
    Rectangle all{1e9, 1e9, -1e9, -1e9};
    for (size_t k = 0; rows > 0 && k < list_.legend.size(); ++k) {
      if (k % rows == 0) left = next;
      const double baseline = margin_ + capital_ + line * static_cast<double>(k % rows);
      LegendLine row{{left, baseline - capital_, left + capital_, baseline}, list_.legend[k].color, {}};
      row.name = {list_.legend[k].text, left + 1.8 * capital_, baseline, small};
      const double end = row.name.bounds().right;
      if (end > width_ - 0.5 * margin_) break;
      next = std::max(next, end + 2 * capital_);
      all = around(all, around(row.swatch, row.name.bounds()));
      out_.legend.push_back(std::move(row));
    }
    if (!out_.legend.empty()) add_panel(all);
  }

  bool is_free(const TextLine& line) const {
    const Rectangle r = line.bounds();
    if (r.left < 0 || r.top < 0 || r.right > width_ || r.bottom > height_) return false;
    const auto meets = [&](const Rectangle& o) { return o.meets(r); };
    return std::none_of(out_.panels.begin(), out_.panels.end(), meets) &&
           std::none_of(out_.labels.begin(), out_.labels.end(),
                        [&](const TextLine& l) { return meets(l.bounds()); });
  }

  void place_labels(const View& view) {
    for (const DrawLabel& label : list_.labels) {
      if (label.side != DrawLabel::Side::beside) place_label(view, label);
    }
    for (const DrawLabel& label : list_.labels) {
      if (label.side == DrawLabel::Side::beside) place_label(view, label);
    }
  }

  // Labels never leave the picture: one at its edge is moved inside. A name beside a thing is where there is
  // room, or nowhere.
  void place_label(const View& view, const DrawLabel& label) {
    using Side = DrawLabel::Side;
    const Vec3f p = view.units.position(label.at);
    const Vec3 q = Vec3{p.x, p.y, p.z} - view.eye;
    const double depth = -dot(q, view.back);
    if (!(depth > view.near_plane)) return;
    const double x = 0.5 * width_ + dot(q, view.right) / (depth * view.pixel);
    const double y = 0.5 * height_ - dot(q, view.above) / (depth * view.pixel);
    if (x < 0 || y < 0 || x > width_ || y > height_) return;
    const double capital = 0.85 * capital_, width = text_width(label.text, capital);
    const double gap = 0.8 * capital + view.units.length(label.radius) / (depth * view.pixel);
    const double edge = 0.6 * capital;
    const auto at = [&](Side side) {
      double dx = gap, dy = 0.5 * capital;
      if (side == Side::left) dx = -width - gap;
      // Names on four sides of one thing do not touch.
      const double more = label.side == Side::beside ? 0.4 * capital : 0;
      if (side == Side::above) dx = -0.5 * width, dy = -gap - more;
      if (side == Side::below) dx = -0.5 * width, dy = gap + capital + more;
      if (side == Side::under) dx = -0.5 * width, dy = 2.4 * gap + 2 * capital;
      if (side == Side::corner) dx = -width, dy = -gap;
      TextLine line{label.text, std::clamp(x + dx, edge, std::max(edge, width_ - width - edge)),
                    std::clamp(y + dy, capital + edge, height_ - edge), capital, label.color};
      return line;
    };
    if (label.side != Side::beside) {
      out_.labels.push_back(at(label.side));
      return;
    }
    for (const Side side : {Side::right, Side::left, Side::above, Side::below}) {
      const TextLine line = at(side);
      if (!is_free(line)) continue;
      out_.labels.push_back(line);
      return;
    }
  }

  const DrawList& list_;
  int width_, height_;
  double capital_, margin_;
  OverlayLayout out_;
};

}  // namespace

Rectangle TextLine::bounds() const {
  return {x, baseline - 1.1 * capital, x + text_width(text, capital), baseline + kDescent * capital};
}

std::optional<DrawScale> scale_of(const DrawList& list) {
  const auto labelled = std::find_if(list.points.begin(), list.points.end(), [](const DrawPoints& set) {
    return has_scalars(set) && !set.scalar_label.empty();
  });
  if (labelled == list.points.end()) return list.scale;
  const auto [low, high] = scalar_range(*labelled);
  return DrawScale{labelled->scalar_label, labelled->color_map, low, high};
}

OverlayLayout layout_overlay(const DrawList& list, const View* view, int width, int height) {
  return Layout(list, width, height).make(view);
}

}  // namespace truestep::picture
