// Glyphs as polylines on a grid of 5 columns (0 to 4) and 9 rows: 2 is the baseline, 6 the top of small
// letters, 8 that of capitals, 0 the foot of a g. Two digits are a point (column, row), a blank lifts the
// pen, a single point is a dot. Coverage of a pixel is its distance to the nearest stroke.
#include "engine/sinks/picture/draw/stroke_font.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace truestep::picture {
namespace {

struct Glyph {
  char character;
  const char* strokes;
};

// clang-format off
constexpr Glyph kGlyphs[] = {
    {'!', "2824 2222"}, {'#', "1218 3238 0444 0646"}, {'%', "0248 0707 4343"},
    {'\'', "2826"}, {'(', "38272332"}, {')', "18272312"},
    {'*', "2327 1436 3416"}, {'+', "0545 2327"}, {',', "2211"},
    {'-', "1535"}, {'.', "2222"}, {'/', "0148"},
    {'0', "120307183847433212"}, {'1', "172822 1232"}, {'2', "07183847460242"},
    {'3', "07183847463515 354443321203"}, {'4', "32380444"}, {'5', "480805354443321203"},
    {'6', "473818070312324344351504"}, {'7', "084812"}, {'8', "150607183847463515 1504031232434435"},
    {'9', "463515060718384743321203"}, {':', "2222 2525"}, {';', "2211 2525"},
    {'<', "470543"}, {'=', "0444 0646"}, {'>', "074503"},
    {'?', "07183847462524 2222"}, {'A', "022842 1434"}, {'B', "02083847463505 354443321202"},
    {'C', "4738180703123243"}, {'D', "02082846442202"}, {'E', "42020848 0535"},
    {'F', "020848 0535"}, {'G', "47381807031232434525"}, {'H', "0208 4248 0545"},
    {'I', "1232 2228 1838"}, {'J', "4843321203"}, {'K', "0208 4804 1542"},
    {'L', "080242"}, {'M', "0208254842"}, {'N', "02084248"},
    {'O', "120307183847433212"}, {'P', "02083847463505"}, {'Q', "120307183847433212 2442"},
    {'R', "02083847463505 2542"}, {'S', "473818070615354443321203"}, {'T', "0848 2822"},
    {'U', "080312324348"}, {'V', "082248"}, {'W', "0812263248"},
    {'X', "0248 0842"}, {'Y', "082548 2522"}, {'Z', "08480242"},
    {'[', "38181232"}, {']', "18383212"}, {'^', "162836"},
    {'_', "0141"}, {'a', "4642 4536160503123243"}, {'b', "0802 0516364543321203"},
    {'c', "4536160503123243"}, {'d', "4842 4536160503123243"}, {'e', "04444536160503123243"},
    {'f', "48382722 1646"}, {'g', "4641301001 4536160503123243"}, {'h', "0802 0516364542"},
    {'i', "2622 2828"}, {'j', "36312010 3838"}, {'k', "0802 4603 1442"},
    {'l', "18282332"}, {'m', "0602 05162522 25364542"}, {'n', "0602 0516364542"},
    {'o', "160503123243453616"}, {'p', "0600 0516364543321203"}, {'q', "4640 4536160503123243"},
    {'r', "0602 05163645"}, {'s', "45361605143443321203"}, {'t', "1813223243 0636"},
    {'u', "0603123243 4642"}, {'v', "062246"}, {'w', "0612243246"},
    {'x', "0246 0642"}, {'y', "0622 461000"}, {'z', "06460242"},
    {'|', "2028"}};
// clang-format on

constexpr double kCapital = 6, kGap = 1.9, kBlank = 2.6;  // grid units

const char* strokes_of(char c) {
  const auto find = [](char x) {
    return std::find_if(std::begin(kGlyphs), std::end(kGlyphs),
                        [x](const Glyph& g) { return g.character == x; });
  };
  const Glyph* g = find(c);
  return g != std::end(kGlyphs) ? g->strokes : find('?')->strokes;
}

// Leftmost and rightmost column; all digits take the full width, so that a running clock does not jitter.
std::pair<double, double> columns(char c) {
  if (c >= '0' && c <= '9') return {0, 4};
  int low = 4, high = 0;
  for (const char* p = strokes_of(c); *p; p += p[0] == ' ' ? 1 : 2) {
    if (*p == ' ') continue;
    low = std::min(low, *p - '0');
    high = std::max(high, *p - '0');
  }
  return {low, high};
}

// Distance from (x, y) to the segment from a to b.
double distance(double x, double y, const double (&a)[2], const double (&b)[2]) {
  const double dx = b[0] - a[0], dy = b[1] - a[1], length2 = dx * dx + dy * dy;
  const double t = length2 > 0 ? std::clamp(((x - a[0]) * dx + (y - a[1]) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(x - a[0] - t * dx, y - a[1] - t * dy);
}

struct Pen {
  std::vector<float>& coverage;
  int width, height;
  double half_stroke;

  void segment(const double (&a)[2], const double (&b)[2]) {
    const double reach = half_stroke + 1;
    const auto from = [&](double c) { return std::max(0, static_cast<int>(std::floor(c - reach))); };
    const auto to = [&](double c, int end) { return std::min(end, static_cast<int>(std::ceil(c + reach))); };
    for (int y = from(std::min(a[1], b[1])); y < to(std::max(a[1], b[1]), height); ++y)
      for (int x = from(std::min(a[0], b[0])); x < to(std::max(a[0], b[0]), width); ++x) {
        float& c = coverage[static_cast<size_t>(y) * width + x];
        const double here = half_stroke + 0.5 - distance(x + 0.5, y + 0.5, a, b);
        c = std::max(c, static_cast<float>(std::clamp(here, 0.0, 1.0)));
      }
  }
};

}  // namespace

double text_width(std::string_view text, double capital_height) {
  double units = 0;
  for (char c : text) {
    const auto [low, high] = columns(c);
    units += c == ' ' ? kBlank : high - low + kGap;
  }
  return std::max(units - kGap, 0.0) * capital_height / kCapital;
}

std::vector<float> text_coverage(std::string_view text, const TextPlace& place, int width, int height) {
  std::vector<float> coverage(static_cast<size_t>(width) * height);
  Pen pen{coverage, width, height, place.stroke / 2};
  const double unit = place.capital_height / kCapital;
  double left = place.x;
  for (char c : text) {
    if (c == ' ') {
      left += kBlank * unit;
      continue;
    }
    const auto [low, high] = columns(c);
    double last[2] = {0, 0};
    bool down = false;
    for (const char* p = strokes_of(c); *p;) {
      if (*p == ' ') {
        down = false, ++p;
        continue;
      }
      const double point[2] = {left + (p[0] - '0' - low) * unit, place.y - (p[1] - '2') * unit};
      pen.segment(down ? last : point, point);
      last[0] = point[0], last[1] = point[1];
      down = true, p += 2;
    }
    left += (high - low + kGap) * unit;
  }
  return coverage;
}

}  // namespace truestep::picture
