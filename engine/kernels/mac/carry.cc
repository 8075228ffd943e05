#include "engine/kernels/mac/carry.h"

#include <algorithm>
#include <cmath>

namespace truestep::mac {

double largest_outflow(const MacGrid& g, const ConstFields& u, const ThreadArena& arena) {
  return largest_of_rows(g, kCentre, arena, [&](size_t at, size_t n) {
    double most = 0;
    for (size_t i = at; i < at + n; ++i) {
      double sum = 0;
      for (size_t a = 0; a < g.dimensions; ++a) {
        const double low = u[a][i], high = u[a][i + g.stride(a)];
        sum += ((high > 0 ? high : 0) - (low < 0 ? low : 0)) / g.spacing[a];
      }
      most = sum > most ? sum : most;
    }
    return most;
  });
}

namespace {
// The monotonized central slope from the differences to both neighbours.
double slope_of(double before, double after) {
  const double mean = 0.5 * (before + after), steepest = 2 * std::min(std::abs(before), std::abs(after));
  const double size = std::min(std::abs(mean), steepest);
  return before * after > 0 ? (mean < 0 ? -size : size) : 0;
}

// Of n faces along a line of x, s apart from their cells along the axis.
void row_flux(double per, size_t s, size_t n, const double* u, const double* q, const double* room,
              double* flux) {
  const double *low = q - s, *lower = low - s, *higher = q + s, *low_room = room - s;
#pragma GCC ivdep
  for (size_t i = 0; i < n; ++i) {
    const double crossed = per * u[i];
    const bool up = crossed > 0;
    const double across = q[i] - low[i], behind = up ? low[i] - lower[i] : higher[i] - q[i];
    const double value = up ? low[i] : q[i], from = up ? low_room[i] : room[i];
    const double lean = 0.5 * slope_of(across, behind) * (1 - std::abs(crossed) / from);
    flux[i] = crossed * (up ? value + lean : value - lean);
  }
}
}  // namespace

void scalar_flux(const MacGrid& g, size_t axis, const double* u, double h, const double* q,
                 const double* room, double* flux, const ThreadArena& arena) {
  const double per = h / g.spacing[axis];
  const size_t s = g.stride(axis);
  for_rows(g, kCentre, arena, [&](size_t at, size_t j, size_t k, size_t n) {
    const size_t faces = axis == 0 ? n + 1 : n;
    row_flux(per, s, faces, u + at, q + at, room + at, flux + at);
    // The faces after the last cells.
    const size_t row = axis == 1 ? j : k;
    if (axis == 0 || row + 1 != g.cells[axis]) return;
    row_flux(per, s, n, u + at + s, q + at + s, room + at + s, flux + at + s);
  });
}

void pass_scalar(const MacGrid& g, size_t axis, const double* u, double h, const double* flux,
                 double* content, double* room, double* q, const ThreadArena& arena) {
  const double per = h / g.spacing[axis];
  const size_t s = g.stride(axis);
  for_rows(g, kCentre, arena, [&](size_t at, size_t, size_t, size_t n) {
    const double *low = flux + at, *high = low + s, *v = u + at, *w = v + s;
    double *c = content + at, *r = room + at, *to = q + at;
#pragma GCC ivdep
    for (size_t i = 0; i < n; ++i) {
      c[i] -= high[i] - low[i];
      r[i] -= per * w[i] - per * v[i];
      to[i] = c[i] / r[i];
    }
  });
}

}  // namespace truestep::mac
