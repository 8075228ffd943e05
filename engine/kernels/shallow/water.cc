#include "engine/kernels/shallow/water.h"

#include <algorithm>
#include <cmath>

namespace truestep::shallow {

namespace {

constexpr size_t kColumns = 64;  // of a tile

// By value, so that loops vectorise.
inline double least(double a, double b) {
  return a < b ? a : b;
}
inline double most(double a, double b) {
  return a > b ? a : b;
}

// The mean of both differences, limited to twice either, 0 when their signs differ.
inline double slope(double a, double b) {
  const double low = least(a, b), high = most(a, b), mean = 0.5 * (a + b);
  return most(0, least(2 * low, mean)) + least(0, most(2 * high, mean));
}
inline double slope_at(const double* q, ptrdiff_t s) {
  return slope(q[0] - q[-s], q[s] - q[0]);
}

struct Fluxes {
  // Fluxes of mass, of normal momentum for the cell before and after the face, and of transverse momentum.
  double mass[kColumns + 1], before[kColumns + 1], after[kColumns + 1], across[kColumns + 1];
};

// Faces between the cells at 0 .. n - 1 of the pointers and those a stride after them. The bed's force on a
// cell is included as the pressure of its own depth at the face; the rest of it, g h times the surface's
// slope, is left to the caller.
void face_fluxes(const double* h, const double* eta, const double* normal, const double* other, ptrdiff_t s,
                 double g, size_t n, Fluxes& out, double* fastest) {
  for (size_t i = 0; i < n; ++i) {
    const double h0 = h[i] + 0.5 * slope_at(h + i, s), h1 = h[i + s] - 0.5 * slope_at(h + i + s, s);
    const double e0 = eta[i] + 0.5 * slope_at(eta + i, s), e1 = eta[i + s] - 0.5 * slope_at(eta + i + s, s);
    const double u0 = normal[i] + 0.5 * slope_at(normal + i, s);
    const double u1 = normal[i + s] - 0.5 * slope_at(normal + i + s, s);
    const double w0 = other[i] + 0.5 * slope_at(other + i, s);
    const double w1 = other[i + s] - 0.5 * slope_at(other + i + s, s);
    const double bed = most(e0 - h0, e1 - h1);
    const double d0 = most(0, e0 - bed), d1 = most(0, e1 - bed);
    const double c0 = std::sqrt(g * d0), c1 = std::sqrt(g * d1);
    // Water runs onto dry ground at u + 2 c.
    const double low = d0 > 0 ? least(u0 - c0, d1 > 0 ? u1 - c1 : u0 - c0) : u1 - 2 * c1;
    const double high = d1 > 0 ? most(u1 + c1, d0 > 0 ? u0 + c0 : u1 + c1) : u0 + 2 * c0;
    const double sl = least(low, 0), sr = most(high, 0);
    const double share = 1 / most(sr - sl, 1e-300);
    const double m0 = d0 * u0, m1 = d1 * u1, p0 = 0.5 * g * d0 * d0, p1 = 0.5 * g * d1 * d1;
    const double mass = (sr * m0 - sl * m1 + sl * sr * (d1 - d0)) * share;
    const double momentum = (sr * (m0 * u0 + p0) - sl * (m1 * u1 + p1) + sl * sr * (m1 - m0)) * share;
    out.mass[i] = mass;
    out.before[i] = momentum - p0;
    out.after[i] = momentum - p1;
    out.across[i] = mass * (mass > 0 ? w0 : w1);
    fastest[i] = most(fastest[i], most(-sl, sr));
  }
}

}  // namespace

void fill_edges(const Basin& b, size_t normal_axis, double* q) {
  constexpr size_t kG = Basin::kGhosts;
  for (size_t a = 0; a < b.dimensions; ++a) {
    const size_t stride = a == 0 ? 1 : b.row(), across = a == 0 ? b.row() : 1, n = b.cells[a];
    const size_t lines = a == 0 ? b.padded() / b.row() : b.row();
    const double turned = a == normal_axis ? -1 : 1;
    for (size_t line = 0; line < lines; ++line) {
      double* const first = q + line * across + kG * stride;
      for (size_t m = 0; m < kG; ++m) {
        const auto value = [&](size_t end) {
          const bool low = end == 0;
          switch (b.edges[a][end]) {
            case Edge::periodic:
              return first[(low ? (n - 1 - m % n) : m % n) * stride];
            case Edge::open:
              return first[(low ? 0 : n - 1) * stride];
            default:
              return turned * first[(low ? std::min(m, n - 1) : n - 1 - std::min(m, n - 1)) * stride];
          }
        };
        const double low = value(0), high = value(1);
        *(first - (m + 1) * stride) = low, first[(n + m) * stride] = high;
      }
    }
  }
}

void primitives(const Basin& b, const Water& w, Primitives& p, const ThreadArena& arena) {
  const size_t nx = b.cells[0], block = std::max<size_t>(1, kBlockRows / nx);
  arena.for_blocks(b.cells[1], block, [&](size_t begin, size_t end) {
    for (size_t j = begin; j < end; ++j) {
      const size_t at = b.at(0, j);
      for (size_t i = 0; i < nx; ++i) {
        const double h = w.h[nx * j + i], share = h > b.dry ? 1 / h : 0;
        p.h[at + i] = h;
        p.eta[at + i] = h + p.z[at + i];
        p.u[at + i] = share * w.qx[nx * j + i];
      }
      if (b.dimensions < 2) continue;
      for (size_t i = 0; i < nx; ++i) {
        const double h = w.h[nx * j + i], share = h > b.dry ? 1 / h : 0;
        p.v[at + i] = share * w.qy[nx * j + i];
      }
    }
  });
  fill_edges(b, 2, p.h.data()), fill_edges(b, 2, p.eta.data()), fill_edges(b, 0, p.u.data());
  if (b.dimensions == 2) fill_edges(b, 1, p.v.data());
}

double rates(const Basin& b, const Primitives& p, const Water& out, double* row_speeds,
             const ThreadArena& arena) {
  const size_t nx = b.cells[0], block = std::max<size_t>(8, kBlockRows / nx);
  const auto up = static_cast<ptrdiff_t>(b.row());
  const bool plane = b.dimensions == 2;
  const double per_dx = 1 / b.spacing[0], per_dy = plane ? 1 / b.spacing[1] : 0, g = b.gravity;
  arena.for_blocks(b.cells[1], block, [&](size_t begin, size_t end) {
    std::fill(row_speeds + 2 * begin, row_speeds + 2 * end, 0.0);
    Fluxes x, y[2];
    double speed_x[kColumns + 1] = {}, speed_y[kColumns + 1] = {};
    for (size_t i0 = 0; i0 < nx; i0 += kColumns) {
      const size_t n = std::min(kColumns, nx - i0);
      const auto along_y = [&](size_t j, Fluxes& to) {  // the faces before row j
        const size_t at = b.at(i0, j) - b.row();
        face_fluxes(&p.h[at], &p.eta[at], &p.v[at], &p.u[at], up, g, n, to, speed_y);
      };
      if (plane) along_y(begin, y[begin % 2]);
      for (size_t j = begin; j < end; ++j) {
        const size_t at = b.at(i0, j), row = nx * j + i0;
        face_fluxes(&p.h[at - 1], &p.eta[at - 1], &p.u[at - 1], &p.v[at - 1], 1, g, n + 1, x, speed_x);
        for (size_t i = 0; i < n; ++i) {
          const double push = g * p.h[at + i] * slope_at(&p.eta[at + i], 1);
          out.h[row + i] = -(x.mass[i + 1] - x.mass[i]) * per_dx;
          out.qx[row + i] = -(x.before[i + 1] - x.after[i] + push) * per_dx;
        }
        if (!plane) continue;
        const Fluxes& low = y[j % 2];
        Fluxes& high = y[(j + 1) % 2];
        along_y(j + 1, high);
        for (size_t i = 0; i < n; ++i) {
          const double push = g * p.h[at + i] * slope_at(&p.eta[at + i], up);
          out.h[row + i] -= (high.mass[i] - low.mass[i]) * per_dy;
          out.qx[row + i] -= (high.across[i] - low.across[i]) * per_dy;
          out.qy[row + i] =
              -(x.across[i + 1] - x.across[i]) * per_dx - (high.before[i] - low.after[i] + push) * per_dy;
        }
      }
    }
    row_speeds[2 * begin] = *std::max_element(speed_x, speed_x + kColumns + 1);
    row_speeds[2 * begin + 1] = *std::max_element(speed_y, speed_y + kColumns + 1);
  });
  double sx = 0, sy = 0;
  for (size_t j = 0; j < b.cells[1]; ++j)
    sx = most(sx, row_speeds[2 * j]), sy = most(sy, row_speeds[2 * j + 1]);
  return sx * per_dx + sy * per_dy;
}

}  // namespace truestep::shallow
