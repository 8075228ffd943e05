// Transfers between particles and the staggered grid: each component of velocity, and the density, by linear
// weights on the 2^d values around a particle. With slopes c_pa = sum of u_ia grad w_ip they are those of
// affine particles on a staggered grid (Jiang, Schroeder, Selle, Teran, Stomakhin 2015, "The affine
// particle-in-cell method", section 5.3), which conserve linear and angular momentum and reproduce linear
// fields; without slopes those of PIC and FLIP (Zhu, Bridson 2005, "Animating sand as a fluid").
#pragma once
#include <array>

#include "engine/kernels/mac/mac_grid.h"

namespace truestep::mac {

/// The values around a particle: the lowest one, and the weight of the higher ones along each axis.
template <size_t D>
struct Around {
  size_t at = 0;
  std::array<double, D> share{};
};

/// `cells`: position in cells from the grid's lower corner, inside the box.
template <size_t D>
Around<D> around_particle(const MacGrid& g, size_t place, const double* cells) {
  Around<D> out;
  out.at = g.base();
  for (size_t a = 0; a < D; ++a) {
    // Offset by one so that the truncated value is never negative.
    const double x = cells[a] + (place == a ? 1.0 : 0.5);
    const auto low = static_cast<size_t>(x);
    out.share[a] = x - static_cast<double>(low);
    out.at += g.stride(a) * low - g.stride(a);
  }
  return out;
}

/// f(offset in the array, weight, corner) for each of the 2^D values; bit a of a corner: high along a.
template <size_t D, class F>
void for_corners(const MacGrid& g, const Around<D>& p, F&& f) {
  const size_t s1 = g.stride(1), s2 = D == 3 ? g.stride(2) : 0;
  const double x = p.share[0], y = p.share[1];
  for (size_t k = 0; k < (D == 3 ? 2 : 1); ++k) {
    const double wz = D == 2 ? 1 : k == 0 ? 1 - p.share[D - 1] : p.share[D - 1];
    const size_t at = p.at + k * s2;
    f(at, wz * (1 - y) * (1 - x), 4 * k), f(at + 1, wz * (1 - y) * x, 4 * k + 1);
    f(at + s1, wz * y * (1 - x), 4 * k + 2), f(at + s1 + 1, wz * y * x, 4 * k + 3);
  }
}

/// Adds the weights to `mass` and weights times the particle's value, with its slopes (per metre), to
/// `momentum`; `slope` null: none.
template <size_t D>
void scatter(const MacGrid& g, const Around<D>& p, double value, const double* slope, double* mass,
             double* momentum) {
  std::array<double, D> step{};
  if (slope) {
    for (size_t a = 0; a < D; ++a) {
      step[a] = slope[a] * g.spacing[a];
      value -= step[a] * p.share[a];
    }
  }
  for_corners<D>(g, p, [&](size_t at, double w, size_t corner) {
    double v = value;
    if (slope) {
      for (size_t a = 0; a < D; ++a) v += (corner >> a) & 1 ? step[a] : 0;
    }
    mass[at] += w, momentum[at] += w * v;
  });
}

/// Adds only the weights.
template <size_t D>
void scatter(const MacGrid& g, const Around<D>& p, double* mass) {
  for_corners<D>(g, p, [&](size_t at, double w, size_t) { mass[at] += w; });
}

template <size_t D>
double gather(const MacGrid& g, const Around<D>& p, const double* u) {
  double sum = 0;
  for_corners<D>(g, p, [&](size_t at, double w, size_t) { sum += w * u[at]; });
  return sum;
}

/// Slopes of the interpolated field at the particle (per metre).
template <size_t D>
void gather_slopes(const MacGrid& g, const Around<D>& p, const double* u, double* slope) {
  for (size_t a = 0; a < D; ++a) {
    // Differences along the axis, weighted across it.
    const size_t b = a == 0 ? 1 : 0, c = a == 2 ? 1 : 2;
    const size_t sa = g.stride(a), sb = g.stride(b);
    const auto line = [&](size_t at) { return u[at + sa] - u[at]; };
    const auto plane = [&](size_t at) { return (1 - p.share[b]) * line(at) + p.share[b] * line(at + sb); };
    double d = plane(p.at);
    if constexpr (D == 3) d = (1 - p.share[c]) * d + p.share[c] * plane(p.at + g.stride(c));
    slope[a] = d / g.spacing[a];
  }
}

}  // namespace truestep::mac
