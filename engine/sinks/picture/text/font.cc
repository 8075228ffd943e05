// A contour's edges add, in every row that they cross, the signed height and area that they leave to their
// right; sums along the row are then the share of each pixel inside (as in LCD and font rasterisers since
// FreeType). Curves are parabolas, cut into edges of about half a pixel.
#include "engine/sinks/picture/text/font.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/sinks/picture/text/font_outlines.h"

namespace truestep::picture {
namespace {

struct Point {
  double x, y;
};

const Outline* find(uint32_t code) {
  const auto all = outlines();
  const auto at =
      std::lower_bound(all.begin(), all.end(), code, [](const Outline& o, uint32_t c) { return o.code < c; });
  return at != all.end() && at->code == code ? &*at : nullptr;
}

/// Calls f(outline) for every character of UTF-8 text.
template <class F>
void for_letters(std::string_view text, F&& f) {
  for (size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    const int more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : lead >= 0xC0 ? 1 : 0;
    uint32_t code = more == 0 ? lead : lead & (0x3Fu >> more);
    for (int k = 0; k < more && i < text.size() && (text[i] & 0xC0) == 0x80; ++k)
      code = code << 6 | (static_cast<unsigned char>(text[i++]) & 0x3Fu);
    const Outline* outline = find(code);
    f(outline ? *outline : *find('?'));
  }
}

class Raster {
 public:
  Raster(int width, int height)
      : width_(width), height_(height), sums_(static_cast<size_t>(width + 2) * std::max(height, 0)) {}

  void line(Point a, Point b) {
    if (a.y == b.y) return;
    const double sign = a.y < b.y ? 1 : -1;
    if (sign < 0) std::swap(a, b);
    const double slope = (b.x - a.x) / (b.y - a.y);
    const int last = std::min(height_ - 1, static_cast<int>(std::floor(b.y)));
    for (int y = std::max(0, static_cast<int>(std::floor(a.y))); y <= last; ++y) {
      const double top = std::max(a.y, 1.0 * y), bottom = std::min(b.y, y + 1.0);
      if (bottom > top)
        in_row(y, a.x + (top - a.y) * slope, a.x + (bottom - a.y) * slope, sign * (bottom - top));
    }
  }

  void curve(Point a, Point c, Point b) {
    const double size = std::abs(a.x - 2 * c.x + b.x) + std::abs(a.y - 2 * c.y + b.y);
    const int pieces = std::clamp(static_cast<int>(std::ceil(2 * std::sqrt(size))), 1, 32);
    Point from = a;
    for (int k = 1; k <= pieces; ++k) {
      const double t = static_cast<double>(k) / pieces, s = 1 - t;
      const Point to{s * s * a.x + 2 * s * t * c.x + t * t * b.x,
                     s * s * a.y + 2 * s * t * c.y + t * t * b.y};
      line(from, to);
      from = to;
    }
  }

  std::vector<float> coverage() const {
    std::vector<float> out(static_cast<size_t>(width_) * height_);
    for (int y = 0; y < height_; ++y) {
      double sum = 0;
      for (int x = 0; x < width_; ++x) {
        sum += sums_[static_cast<size_t>(y) * (width_ + 2) + x];
        out[static_cast<size_t>(y) * width_ + x] = static_cast<float>(std::min(1.0, std::abs(sum)));
      }
    }
    return out;
  }

 private:
  // A piece of an edge within a row, from x0 to x1, `height` of the row high.
  void in_row(int y, double x0, double x1, double height) {
    double* row = &sums_[static_cast<size_t>(y) * (width_ + 2)];
    const double low = std::clamp(std::min(x0, x1), 0.0, 1.0 * width_);
    const double high = std::clamp(std::max(x0, x1), 0.0, 1.0 * width_);
    const int first = static_cast<int>(low), last = static_cast<int>(high);
    for (int x = first; x <= last; ++x) {
      const double from = std::max(low, 1.0 * x), to = std::min(high, x + 1.0);
      const double share = high > low ? (to - from) / (high - low) : 1;
      const double left = 1 - (0.5 * (from + to) - x);  // of the pixel, right of the edge
      row[x] += height * share * left;
      row[x + 1] += height * share * (1 - left);
    }
  }

  int width_, height_;
  std::vector<double> sums_;
};

void fill(Raster& raster, const Outline& outline, const TextPlace& place, double x0) {
  const double scale = place.capital_height / kOutlineCapital;
  const auto numbers = outline_numbers();
  size_t at = outline.first;
  for (int c = 0; c < outline.contours; ++c) {
    const auto n = static_cast<size_t>(numbers[at]);
    const size_t first = at + 1;
    at = first + 2 * n;
    const auto on = [&](size_t k) { return (numbers[first + 2 * (k % n)] & 1) != 0; };
    const auto point = [&](size_t k) {
      const size_t i = first + 2 * (k % n);
      return Point{x0 + scale * (numbers[i] >> 1), place.y - scale * numbers[i + 1]};
    };
    const auto middle = [](Point a, Point b) { return Point{0.5 * (a.x + b.x), 0.5 * (a.y + b.y)}; };
    size_t start = 0;
    while (start < n && !on(start)) ++start;
    if (start == n) start = 0;
    Point from = on(start) ? point(start) : middle(point(n - 1), point(0));
    for (size_t k = start + (on(start) ? 1 : 0), end = start + n; k <= end; ++k) {
      if (on(k)) {
        if (k > start) raster.line(from, point(k));
        from = point(k);
        continue;
      }
      if (k == end) break;
      const Point to = on(k + 1) ? point(k + 1) : middle(point(k), point(k + 1));
      raster.curve(from, point(k), to);
      from = to;
      if (on(k + 1)) ++k;
    }
  }
}

}  // namespace

double text_width(std::string_view text, double capital_height) {
  double units = 0;
  for_letters(text, [&](const Outline& o) { units += o.advance; });
  return units * capital_height / kOutlineCapital;
}

std::vector<float> text_coverage(std::string_view text, const TextPlace& place, int width, int height) {
  Raster raster(width, height);
  double x = place.x;
  for_letters(text, [&](const Outline& o) {
    fill(raster, o, place, x);
    x += o.advance * place.capital_height / kOutlineCapital;
  });
  return raster.coverage();
}

std::vector<float> halo_of(std::vector<float> coverage, int width, int height, double reach) {
  // Two averages over boxes, made opaque where half of what they can be.
  const int r = std::max(1, static_cast<int>(std::lround(0.5 * reach)));
  const auto average = [&](size_t from, size_t step, int n) {
    std::vector<float> line(static_cast<size_t>(n));
    for (int i = 0; i < n; ++i) line[i] = coverage[from + step * i];
    float sum = 0;
    for (int i = 0; i < std::min(r, n); ++i) sum += line[i];
    for (int i = 0; i < n; ++i) {
      if (i + r < n) sum += line[i + r];
      if (i > r) sum -= line[i - r - 1];
      coverage[from + step * i] = sum / static_cast<float>(2 * r + 1);
    }
  };
  for (int pass = 0; pass < 2; ++pass) {
    for (int y = 0; y < height; ++y) average(static_cast<size_t>(y) * width, 1, width);
    for (int x = 0; x < width; ++x) average(static_cast<size_t>(x), static_cast<size_t>(width), height);
  }
  for (float& c : coverage) c = std::min(1.0f, 4 * c);
  return coverage;
}

}  // namespace truestep::picture
