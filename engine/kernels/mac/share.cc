#include "engine/kernels/mac/share.h"

#include <algorithm>
#include <cmath>

namespace truestep::mac {

namespace {
// Below the plane m . x = level with 0 <= m1 <= m2 <= m3, m1 + m2 + m3 = 1 and level at most 1/2. Normal
// components smaller than this count as 0: differences of cubes would cancel.
constexpr double kLeast = 1e-6;

double share_of_half(double m1, double m2, double m3, double a) {
  const double m12 = m1 + m2;
  if (a < m1) return a * a * a / (6 * m1 * m2 * m3);
  if (a < m2) return a * (a - m1) / (2 * m2 * m3) + (m1 > 0 ? m1 * m1 / (6 * m2 * m3) : 0);
  if (a >= m12 && m12 <= m3) return (2 * a - m12) / (2 * m3);
  const double six = 6 * m1 * m2 * m3;
  if (a < std::min(m12, m3))
    return (a * a * (3 * m12 - a) + m1 * m1 * (m1 - 3 * a) + m2 * m2 * (m2 - 3 * a)) / six;
  return (a * a * (3 - 2 * a) + m1 * m1 * (m1 - 3 * a) + m2 * m2 * (m2 - 3 * a) + m3 * m3 * (m3 - 3 * a)) /
         six;
}

std::array<double, 3> sorted(const std::array<double, 3>& n) {
  std::array<double, 3> m{std::abs(n[0]), std::abs(n[1]), std::abs(n[2])};
  std::ranges::sort(m);
  for (size_t k = 0; k < 2; ++k) {
    if (m[k] < kLeast * m[2]) m[k] = 0;
  }
  const double sum = m[0] + m[1] + m[2];
  return {m[0] / sum, m[1] / sum, m[2] / sum};
}

double share_of(const std::array<double, 3>& m, double level) {
  if (level <= 0) return 0;
  if (level >= 1) return 1;
  return level <= 0.5 ? share_of_half(m[0], m[1], m[2], level)
                      : 1 - share_of_half(m[0], m[1], m[2], 1 - level);
}

double below_zero(const std::array<double, 3>& n) {
  return std::min(n[0], 0.0) + std::min(n[1], 0.0) + std::min(n[2], 0.0);
}
}  // namespace

double share_below(const std::array<double, 3>& n, double level) {
  const double length = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
  if (length == 0) return level > 0 ? 1 : 0;
  // As seen from the corner that fills first.
  return share_of(sorted(n), (level - below_zero(n)) / length);
}

Border border_with(const std::array<double, 3>& n, double share) {
  // By bisection: the share grows with the level, and the closed form needs roots of cubics.
  constexpr int kHalvings = 52;
  const std::array<double, 3> m = sorted(n);
  const double wanted = std::min(share, 1 - share);
  double low = 0, high = 0.5;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    (share_of(m, middle) < wanted ? low : high) = middle;
  }
  const double level = 0.5 * (low + high);
  return {n, (share <= 0.5 ? level : 1 - level) + below_zero(n)};
}

Border border_in(const MacGrid& g, const double* f, size_t at) {
  std::array<double, 3> best{};
  double steepest = 0;
  const double* here = f + at;
  for (size_t a = 0; a < g.dimensions; ++a) {
    const auto s = static_cast<ptrdiff_t>(g.stride(a));
    if (here[-s] == here[s]) continue;
    std::array<double, 3> n{};
    n[a] = here[-s] > here[s] ? 1 : -1;
    double length = 1;
    for (size_t b = 0; b < g.dimensions; ++b) {
      if (b == a) continue;
      const auto w = static_cast<ptrdiff_t>(g.stride(b));
      n[b] = 0.5 * ((here[-w - s] + here[-w] + here[-w + s]) - (here[w - s] + here[w] + here[w + s]));
      length += std::abs(n[b]);
    }
    if (1 / length <= steepest) continue;
    steepest = 1 / length;
    for (size_t b = 0; b < 3; ++b) best[b] = n[b] / length;
  }
  return steepest > 0 ? border_with(best, here[0]) : Border{};
}

double share_between(const Border& border, size_t axis, double low, double high) {
  std::array<double, 3> n = border.normal;
  const double level = border.level - n[axis] * low;
  n[axis] *= high - low;
  return (high - low) * share_below(n, level);
}

// By parts, F(1) - integral of what is filled below a place, with Simpson's rule: exact but for the intervals
// in which the plane meets an edge.
double share_moment(const Border& border, size_t axis) {
  constexpr int kIntervals = 8;
  constexpr double kWidth = 1.0 / kIntervals;
  double below = 0, sum = 0;
  for (int k = 0; k < kIntervals; ++k) {
    const double middle = share_between(border, axis, 0, (k + 0.5) * kWidth);
    const double end = share_between(border, axis, 0, (k + 1) * kWidth);
    sum += kWidth / 6 * (below + 4 * middle + end);
    below = end;
  }
  return below - sum;
}

namespace {
// Volume that crosses a face upwards, as a share of a cell; `crossed` in cells.
double crossing(const MacGrid& g, const double* f, size_t axis, size_t high, double crossed) {
  const size_t donor = crossed > 0 ? high - g.stride(axis) : high;
  const double share = f[donor];
  if (share <= 0 || share >= 1 || crossed == 0) return crossed * share;
  const Border border = border_in(g, f, donor);
  if (border.normal == std::array<double, 3>{}) return crossed * share;
  return crossed > 0 ? share_between(border, axis, 1 - crossed, 1)
                     : -share_between(border, axis, 0, -crossed);
}
}  // namespace

void share_flux(const MacGrid& g, size_t axis, const double* u, double h, const double* f, double* flux,
                const ThreadArena& arena) {
  const double per = h / g.spacing[axis];
  const size_t s = g.stride(axis);
  for_rows(g, kCentre, arena, [&](size_t at, size_t j, size_t k, size_t n) {
    for (size_t i = at; i < at + n; ++i) flux[i] = crossing(g, f, axis, i, per * u[i]);
    // The face after the last cell.
    if (axis == 0) flux[at + n] = crossing(g, f, axis, at + n, per * u[at + n]);
    const size_t row = axis == 1 ? j : k;
    if (axis == 0 || row + 1 != g.cells[axis]) return;
    for (size_t i = at + s; i < at + s + n; ++i) flux[i] = crossing(g, f, axis, i, per * u[i]);
  });
}

void carry_share(const MacGrid& g, size_t axis, Sweep sweep, const double* u, double h, const double* f,
                 const double* flux, const double* full, double* swelling, double* to,
                 const ThreadArena& arena) {
  const double per = h / g.spacing[axis];
  const size_t s = g.stride(axis);
  for_rows(g, kCentre, arena, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) {
      const double swells = full[i] * (per * u[i + s] - per * u[i]);
      to[i] = f[i] - (flux[i + s] - flux[i]) + (sweep == Sweep::last ? -swelling[i] : swells);
      swelling[i] += swells;
    }
  });
}

}  // namespace truestep::mac
