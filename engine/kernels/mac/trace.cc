#include "engine/kernels/mac/trace.h"

#include <algorithm>
#include <cmath>

namespace truestep::mac {

namespace {

struct Around {
  size_t at = 0;
  double share[3] = {};
  size_t up[3] = {};
};

Around around(const MacGrid& g, size_t place, const double* cells) {
  Around out;
  out.at = g.base();
  for (size_t a = 0; a < g.dimensions; ++a) {
    const auto n = static_cast<double>(g.cells[a]);
    double x = cells[a];
    if (g.periodic[a]) {
      x -= n * std::floor(x / n);
      if (!(x < n)) x = 0;
    } else {
      x = std::clamp(x, 0.0, n);
    }
    if (place != a) x -= 0.5;
    const double low = std::floor(x);
    out.share[a] = x - low;
    out.at += g.stride(a) * static_cast<size_t>(static_cast<ptrdiff_t>(low) + 1) - g.stride(a);
    out.up[a] = g.stride(a);
  }
  return out;
}

double mix(double a, double b, double share) {
  return a + share * (b - a);
}

double value(const MacGrid& g, const Around& p, const double* u) {
  const double* q = u + p.at;
  const auto row = [&](const double* r) { return mix(r[0], r[1], p.share[0]); };
  const auto plane = [&](const double* r) { return mix(row(r), row(r + p.up[1]), p.share[1]); };
  return g.dimensions == 2 ? plane(q) : mix(plane(q), plane(q + p.up[2]), p.share[2]);
}

Limits extremes(const MacGrid& g, const Around& p, const double* u) {
  Limits l{u[p.at], u[p.at]};
  for (size_t corner = 1; corner < (size_t{1} << g.dimensions); ++corner) {
    size_t at = p.at;
    for (size_t a = 0; a < g.dimensions; ++a) at += ((corner >> a) & 1) * p.up[a];
    l.low = std::min(l.low, u[at]), l.high = std::max(l.high, u[at]);
  }
  return l;
}

// Velocity in cells per second at the place of value i, j, k; components stored elsewhere are averaged from
// the faces around it.
void velocity_at(const MacGrid& g, size_t place, const ConstFields& u, size_t at, double* v) {
  for (size_t a = 0; a < g.dimensions; ++a) {
    const double *q = u[a] + at, scale = 1 / g.spacing[a];
    const size_t sa = g.stride(a);
    if (place == a) {
      v[a] = q[0] * scale;
    } else if (place == kCentre) {
      v[a] = 0.5 * (q[0] + q[sa]) * scale;
    } else {
      const size_t sp = g.stride(place);
      v[a] = 0.25 * (q[0] + q[sa] + (q - sp)[0] + (q - sp)[sa]) * scale;
    }
  }
}

// Start, in cells, of the path that ends at value (i, j, k) after h.
void departure(const MacGrid& g, size_t place, const ConstFields& u, double h, size_t at, const size_t* index,
               double* x) {
  double v[3], middle[3] = {}, start[3] = {};
  velocity_at(g, place, u, at, v);
  for (size_t a = 0; a < g.dimensions; ++a) {
    start[a] = static_cast<double>(index[a]) + (place == a ? 0 : 0.5);
    middle[a] = start[a] - 0.5 * h * v[a];
  }
  for (size_t a = 0; a < g.dimensions; ++a)
    x[a] = start[a] - h / g.spacing[a] * interpolate(g, a, u[a], middle);
}

template <class F>
void for_departures(const MacGrid& g, size_t place, const ConstFields& u, double h, const ThreadArena& arena,
                    F&& f) {
  for_rows(g, place, arena, [&](size_t at, size_t j, size_t k, size_t n) {
    for (size_t i = 0; i < n; ++i) {
      const size_t index[] = {i, j, k};
      double x[3] = {};
      departure(g, place, u, h, at + i, index, x);
      f(at + i, around(g, place, x));
    }
  });
}

}  // namespace

double interpolate(const MacGrid& g, size_t place, const double* u, const double* cells) {
  return value(g, around(g, place, cells), u);
}

Limits limits_around(const MacGrid& g, size_t place, const double* u, const double* cells) {
  return extremes(g, around(g, place, cells), u);
}

void trace(const MacGrid& g, size_t place, const ConstFields& u, double h, const double* from, double* to,
           const ThreadArena& arena) {
  for_departures(g, place, u, h, arena, [&](size_t at, const Around& p) { to[at] = value(g, p, from); });
}

void correct(const MacGrid& g, size_t place, const ConstFields& u, double h, const double* from,
             const double* ahead, const double* back, double* to, const ThreadArena& arena) {
  for_departures(g, place, u, h, arena, [&](size_t at, const Around& p) {
    const Limits l = extremes(g, p, from);
    to[at] = std::clamp(ahead[at] + 0.5 * (from[at] - back[at]), l.low, l.high);
  });
}

void trace_limited(const MacGrid& g, size_t place, const ConstFields& u, double h, const double* from,
                   const double* compensated, double* to, const ThreadArena& arena) {
  for_departures(g, place, u, h, arena, [&](size_t at, const Around& p) {
    const Limits l = extremes(g, p, from);
    to[at] = std::clamp(value(g, p, compensated), l.low, l.high);
  });
}

}  // namespace truestep::mac
