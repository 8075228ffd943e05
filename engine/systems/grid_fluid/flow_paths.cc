// Advection along paths, and vorticity confinement.
#include <algorithm>
#include <cmath>

#include "engine/kernels/mac/trace.h"
#include "engine/systems/grid_fluid/flow.h"

namespace truestep::grid_fluid {

using mac::kCentre;

void Flow::advect(size_t place, const mac::Sides& sides, const mac::ConstFields& u, double h,
                  const double* from, double* to) {
  using A = GridFluidDef::Advection;
  const mac::MacGrid& g = model_->grid;
  const A kind = model_->def.advection;
  mac::trace(g, place, u, h, from, to, *arena_);
  if (kind == A::semi_lagrangian) return;
  double *back = array(7), *fixed = array(8);
  mac::fill_ghosts(g, place, sides, to, *arena_);
  mac::trace(g, place, u, -h, to, back, *arena_);
  if (kind == A::bfecc) {
    mac::for_rows(g, place, *arena_, [&](size_t at, size_t, size_t, size_t n) {
      for (size_t i = 0; i < n; ++i) fixed[at + i] = from[at + i] + 0.5 * (from[at + i] - back[at + i]);
    });
    mac::fill_ghosts(g, place, sides, fixed, *arena_);
    mac::trace_limited(g, place, u, h, from, fixed, to, *arena_);
  } else {
    mac::correct(g, place, u, h, from, to, back, fixed, *arena_);
    mac::for_rows(g, place, *arena_,
                  [&](size_t at, size_t, size_t, size_t n) { std::copy_n(fixed + at, n, to + at); });
  }
}

void Flow::along_paths(FlowFields& f, double t, double h) {
  const mac::MacGrid& g = model_->grid;
  fill(f, t);
  if (f.scalar) mac::fill_ghosts(g, kCentre, scalar_sides_, f.scalar, *arena_);
  for (size_t c = 0; c < g.dimensions; ++c) {
    advect(c, sides_[c], {f.u[0], f.u[1], f.u[2]}, h, f.u[c], array(3 + c));
  }
  for (size_t c = 0; c < g.dimensions; ++c) {
    double* moved = array(3 + c);
    if (f.second) convect_at_border(f, c, h, moved);
    add_force(f, t, c, h, moved);
    const auto x = model_->unknown(c, 0), y = model_->unknown(c, 1), z = model_->unknown(c, 2);
    mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t k, size_t) {
      if (j < y[0] || j >= y[1] || k < z[0] || k >= z[1]) return;
      for (size_t i = x[0]; i < x[1]; ++i) f.u[c][at + i] = moved[at + i];
    });
  }
  if (model_->def.vorticity_confinement > 0) confine(f, h);
  if (f.viscosity > 0) {
    fill(f, t + h);
    for (size_t c = 0; c < g.dimensions; ++c) {
      double* change = array(c);
      mac::fill_all(g, 0.0, change, *arena_);
      mac::add_laplacian(g, c, f.u[c], h * f.viscosity, change, *arena_);
      viscous_[c]->solve(1, h * f.viscosity, change, *arena_);
    }
    for (size_t c = 0; c < g.dimensions; ++c) {
      const auto x = model_->unknown(c, 0), y = model_->unknown(c, 1), z = model_->unknown(c, 2);
      const double* change = array(c);
      mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t k, size_t) {
        if (j < y[0] || j >= y[1] || k < z[0] || k >= z[1]) return;
        for (size_t i = x[0]; i < x[1]; ++i) f.u[c][at + i] += change[at + i];
      });
    }
  }
  if (f.second) {
    // Starts from the last pressure, which leaves conjugate gradients little to do.
    mac::fill_ghosts(g, kCentre, pressure_sides_, f.pressure, *arena_);
    for (size_t c = 0; c < g.dimensions; ++c) subtract_pressure(f, c, f.pressure, h, f.u[c]);
  } else {
    // The whole pressure comes from this projection.
    mac::fill_all(g, 0.0, f.pressure, *arena_);
  }
  project(f, t, h);
}

// Fedkiw, Stam, Jensen 2001, "Visual simulation of smoke", equations 9 to 11: strength spacing (N x curl u),
// N the direction in which the curl's magnitude grows.
void Flow::confine(FlowFields& f, double h) {
  const mac::MacGrid& g = model_->grid;
  fill(f, sides_time_);
  double* curl[3] = {array(0), array(1), array(2)};
  double* size = array(6);
  const bool space = g.dimensions == 3;
  // d u_c / d x_a in a cell, from the mean of the neighbouring values of its faces.
  const auto slope = [&](size_t c, size_t a, size_t at) {
    const size_t sa = g.stride(a), sc = g.stride(c);
    const double* u = f.u[c] + at;
    return (u[sa] + u[sa + sc] - (u - sa)[0] - (u - sa)[sc]) / (4 * g.spacing[a]);
  };
  mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) {
      curl[2][i] = slope(1, 0, i) - slope(0, 1, i);
      curl[0][i] = space ? slope(2, 1, i) - slope(1, 2, i) : 0;
      curl[1][i] = space ? slope(0, 2, i) - slope(2, 0, i) : 0;
      size[i] = std::sqrt(curl[0][i] * curl[0][i] + curl[1][i] * curl[1][i] + curl[2][i] * curl[2][i]);
    }
  });
  mac::fill_ghosts(g, kCentre, scalar_sides_, size, *arena_);
  double* force[3] = {array(3), array(4), array(5)};
  double least = g.spacing[0];
  for (size_t a = 1; a < g.dimensions; ++a) least = std::min(least, g.spacing[a]);
  const double strength = model_->def.vorticity_confinement * least * h;
  mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) {
      double d[3] = {};
      for (size_t a = 0; a < g.dimensions; ++a)
        d[a] = (size[i + g.stride(a)] - size[i - g.stride(a)]) / (2 * g.spacing[a]);
      const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      const double scale = length > 0 ? strength / length : 0;
      force[0][i] = scale * (d[1] * curl[2][i] - d[2] * curl[1][i]);
      force[1][i] = scale * (d[2] * curl[0][i] - d[0] * curl[2][i]);
      force[2][i] = scale * (d[0] * curl[1][i] - d[1] * curl[0][i]);
    }
  });
  for (size_t c = 0; c < g.dimensions; ++c) {
    mac::fill_ghosts(g, kCentre, scalar_sides_, force[c], *arena_);
    const auto x = model_->unknown(c, 0), y = model_->unknown(c, 1), z = model_->unknown(c, 2);
    mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t k, size_t) {
      if (j < y[0] || j >= y[1] || k < z[0] || k >= z[1]) return;
      for (size_t i = x[0]; i < x[1]; ++i)
        f.u[c][at + i] += 0.5 * (force[c][at + i] + force[c][at + i - g.stride(c)]);
    });
  }
}

}  // namespace truestep::grid_fluid
