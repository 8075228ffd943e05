// Two fluids that do not mix: one velocity and pressure for both,
//   u_t + div(u u) = -grad p / density + viscosity lap u + gravity + f,   div u = 0,
// the density of a face being the mean of the two cells', and a cell's the mean by volume, less what its
// border's motion calls for (inertia_of). The unknown is p - density gravity . x, so that gravity acts only
// on the border, as -gravity . x grad density, with x on the border itself: weighing the faces instead puts
// half of a raised border's weight a cell above it, which slows waves by a quarter of k dx. The border is
// transported sharply and conserves volume (kernels/mac/share.h) at the start of a substep; densities are
// constant within it. Near the border momentum is convected with the mass fluxes
// (kernels/mac/border_momentum.h). There is no surface tension.
#include <algorithm>
#include <cmath>

#include "engine/kernels/mac/border_momentum.h"
#include "engine/kernels/mac/stress.h"
#include "engine/systems/grid_fluid/flow.h"

namespace truestep::grid_fluid {

using mac::kCentre;

namespace {
double component(const Vec3& v, size_t a) {
  return a == 0 ? v.x : a == 1 ? v.y : v.z;
}
}  // namespace

double FlowModel::held_gravity(size_t a) const {
  return grid.periodic[a] ? 0 : component(gravity, a);
}

double FlowModel::density_of(double share) const {
  if (!two_fluids()) return def.density;
  return def.density + std::clamp(share, 0.0, 1.0) * (def.second_fluid->density - def.density);
}

// Layers on either side of a border slide past each other, but a face has one velocity: the border is carried
// by the velocity of the layers' edges instead of its own, and the row that it crosses has mass without the
// motion along it. For waves on a border along the row, the two together act like
//   4 share (1 - share) density_1 density_2 / density
// of mass too much, an error of first order in k dx. It is taken off in proportion to the Atwood number,
// which drives such motion: fluids of one density do not feel their border.
double FlowModel::inertia_of(double share, double normal) const {
  const double two = std::clamp(share, 0.0, 1.0), mean = density_of(share);
  const double first = def.density, second = def.second_fluid->density;
  const double atwood = std::abs(second - first) / (second + first);
  return mean - atwood * normal * 4 * two * (1 - two) * first * second / mean;
}

void FlowModel::fill_second(double* share) const {
  // The tangent plane of the function at a cell's centre, from differences across the cell.
  std::array<std::array<std::vector<double>, 2>, 3> ends;
  for (size_t a = 0; a < grid.dimensions; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      mac::MacGrid moved = grid;
      moved.origin[a] += (end == 0 ? -0.5 : 0.5) * grid.spacing[a];
      ends[a][end].resize(grid.size());
      texts.sample(texts.second_where, moved, kCentre, 0, ends[a][end].data());
    }
  }
  texts.sample(texts.second_where, grid, kCentre, 0, share);
  static const ThreadArena kSerial(1);
  mac::for_rows(grid, kCentre, kSerial, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) {
      std::array<double, 3> normal{};
      double level = share[i];
      for (size_t a = 0; a < grid.dimensions; ++a)
        normal[a] = ends[a][0][i] - ends[a][1][i], level += 0.5 * normal[a];
      share[i] = mac::share_below(normal, level);
    }
  });
}

double FlowModel::border_rate() const {
  if (!two_fluids()) return 0;
  const double one = def.density, two = def.second_fluid->density;
  double finest = grid.spacing[0];
  for (size_t a = 1; a < grid.dimensions; ++a) finest = std::min(finest, grid.spacing[a]);
  constexpr double kPi = 3.14159265358979323846;
  return std::sqrt(norm(gravity) * std::abs(one - two) / (one + two) * kPi / finest);
}

void Flow::weigh(FlowFields& f) {
  if (!f.second) return;
  const mac::MacGrid& g = model_->grid;
  mac::fill_ghosts(g, kCentre, scalar_sides_, f.second, *arena_);
  // gravity . x on the border in a cell, at the point of its plane closest to the centre, and its weight.
  double *place = array(0), *counts = array(1);
  // Squares of the components of its unit normal.
  double* across[] = {array(2), array(3), array(4)};
  mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t j, size_t k, size_t n) {
    for (size_t i = 0; i < n; ++i) {
      const double share = std::clamp(f.second[at + i], 0.0, 1.0);
      place[at + i] = 0, counts[at + i] = share * (1 - share);
      for (size_t a = 0; a < g.dimensions; ++a) across[a][at + i] = 0;
      if (counts[at + i] == 0) continue;
      const mac::Border border = mac::border_in(g, f.second, at + i);
      double squares = 0, distance = border.level;
      for (size_t a = 0; a < g.dimensions; ++a) {
        const double slope = border.normal[a] / g.spacing[a];
        distance -= 0.5 * border.normal[a], squares += slope * slope;
      }
      if (squares == 0) {
        counts[at + i] = 0;
        continue;
      }
      const size_t cell[] = {i, j, k};
      for (size_t a = 0; a < g.dimensions; ++a) {
        const double x = g.coordinate(kCentre, a, static_cast<double>(cell[a])) +
                         distance / squares * border.normal[a] / g.spacing[a];
        place[at + i] += model_->held_gravity(a) * x;
        const double slope = border.normal[a] / g.spacing[a];
        across[a][at + i] = slope * slope / squares;
      }
    }
  });
  mac::fill_ghosts(g, kCentre, scalar_sides_, place, *arena_);
  mac::fill_ghosts(g, kCentre, scalar_sides_, counts, *arena_);
  for (size_t a = 0; a < g.dimensions; ++a) mac::fill_ghosts(g, kCentre, scalar_sides_, across[a], *arena_);
  std::array<const double*, 3> weights{};
  for (size_t c = 0; c < g.dimensions; ++c) {
    double *lightness = lightness_[c].data.data(), *lift = lift_[c].data.data();
    weights[c] = lightness;
    const size_t s = g.stride(c);
    // Includes the last face of a periodic axis.
    arena_->for_blocks(g.size(), kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = std::max(begin, s); i < end; ++i) {
        lightness[i] = 2 * model_->def.density /
                       (model_->inertia_of(f.second[i - s], across[c][i - s]) +
                        model_->inertia_of(f.second[i], across[c][i]));
      }
    });
    mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t k, size_t n) {
      for (size_t i = 0; i < n; ++i) {
        const size_t high = at + i, low = high - s;
        const double jump = model_->density_of(f.second[high]) - model_->density_of(f.second[low]);
        lift[high] = 0;
        if (jump == 0) continue;
        const double sum = counts[low] + counts[high];
        double border = 0;
        if (sum > 0) {
          border = (counts[low] * place[low] + counts[high] * place[high]) / sum;
        } else {
          const size_t face[] = {i, j, k};
          for (size_t a = 0; a < g.dimensions; ++a)
            border += model_->held_gravity(a) * g.coordinate(c, a, static_cast<double>(face[a]));
        }
        lift[high] = -border * jump / g.spacing[c] * lightness[high] / model_->def.density;
      }
    });
  }
  cut_pressure_->set_coefficients(weights, *arena_);
  if (model_->two_viscosities()) find_fluidity(f);
}

template <class F>
void Flow::for_border_faces(size_t c, F&& set) {
  const mac::MacGrid& g = model_->grid;
  const double* carried = carried_[c].data.data();
  const std::vector<uint8_t>& beside = beside_border_[c];
  const auto x = model_->unknown(c, 0), y = model_->unknown(c, 1), z = model_->unknown(c, 2);
  mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t k, size_t) {
    if (j < y[0] || j >= y[1] || k < z[0] || k >= z[1]) return;
    for (size_t i = at + x[0]; i < at + x[1]; ++i) {
      if (beside[i]) set(i, carried[i]);
    }
  });
}

void Flow::convect_at_border(size_t c, double* rate) {
  for_border_faces(c, [rate](size_t i, double carried) { rate[i] = carried; });
}

void Flow::convect_at_border(const FlowFields& f, size_t c, double h, double* moved) {
  const double* u = f.u[c];
  for_border_faces(c, [u, h, moved](size_t i, double carried) { moved[i] = u[i] + h * carried; });
}

void Flow::add_weight(size_t c, double factor, double* to) {
  const mac::MacGrid& g = model_->grid;
  const double* lift = lift_[c].data.data();
  const double falls = component(model_->gravity, c) - model_->held_gravity(c);
  mac::for_rows(g, c, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) to[i] += factor * (lift[i] + falls);
  });
}

void Flow::subtract_pressure(const FlowFields& f, size_t c, const double* p, double factor, double* to) {
  const mac::MacGrid& g = model_->grid;
  const double scale = factor / g.spacing[c];
  const double* lightness = f.second ? lightness_[c].data.data() : nullptr;
  const size_t s = g.stride(c);
  const auto x = model_->unknown(c, 0), y = model_->unknown(c, 1), z = model_->unknown(c, 2);
  mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t k, size_t) {
    if (j < y[0] || j >= y[1] || k < z[0] || k >= z[1]) return;
    double* u = to + at;
    const double *high = p + at, *low = high - s;
    if (lightness) {
      const double* w = lightness + at;
      for (size_t i = x[0]; i < x[1]; ++i) u[i] -= scale * w[i] * (high[i] - low[i]);
    } else {
      for (size_t i = x[0]; i < x[1]; ++i) u[i] -= scale * (high[i] - low[i]);
    }
  });
}

void Flow::add_viscosity(const FlowFields& f, size_t c, double viscosity, double* rate) {
  const mac::MacGrid& g = model_->grid;
  if (!model_->two_viscosities()) {
    if (viscosity > 0) mac::add_laplacian(g, c, f.u[c], viscosity, rate, *arena_);
    return;
  }
  mac::add_stress(g, c, {f.u[0], f.u[1], f.u[2]}, fluidity_.data.data(), lightness_[c].data.data(),
                  model_->def.density, rate, *arena_);
}

// 1 / (density viscosity) of each fluid, the mean by volume: layers under one stress.
void Flow::find_fluidity(const FlowFields& f) {
  const mac::MacGrid& g = model_->grid;
  const double one = model_->def.density * f.viscosity,
               two = model_->def.second_fluid->density * *model_->def.second_fluid->viscosity;
  double* fluidity = fluidity_.data.data();
  mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) {
      const double share = std::clamp(f.second[i], 0.0, 1.0);
      fluidity[i] = (share < 1 ? (1 - share) / one : 0) + (share > 0 ? share / two : 0);
    }
  });
  mac::fill_ghosts(g, kCentre, scalar_sides_, fluidity, *arena_);
}

void Flow::note_border(const FlowFields& f, Since since) {
  const mac::MacGrid& g = model_->grid;
  mac::fill_ghosts(g, kCentre, scalar_sides_, f.second, *arena_);
  for (size_t c = 0; c < g.dimensions; ++c) {
    std::vector<uint8_t>& beside = beside_border_[c];
    const auto x = model_->unknown(c, 0), y = model_->unknown(c, 1), z = model_->unknown(c, 2);
    mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t k, size_t) {
      if (j < y[0] || j >= y[1] || k < z[0] || k >= z[1]) return;
      for (size_t i = at + x[0]; i < at + x[1]; ++i) {
        const bool now = mac::beside_border(g, c, f.second, i);
        beside[i] = now || (since == Since::before && beside[i]) ? 1 : 0;
      }
    });
  }
}

// Half of it in the order of the axes and half in the opposite one.
void Flow::carry_border(FlowFields& f, double t, double h, double* share, Carried carried) {
  const mac::MacGrid& g = model_->grid;
  const mac::ConstFields u{f.u[0], f.u[1], f.u[2]};
  const mac::TwoDensities densities{model_->def.density, model_->def.second_fluid->density};
  double *to = array(0), *full = array(1), *swelling = array(2), *flux = array(3), *moved = array(4);
  // Weymouth and Yue's bound is half a cell.
  const int n = std::max(1, static_cast<int>(std::ceil(h * crossing_rate(f, t))));
  const double part = h / (2 * n);
  for (int half = 0; half < 2 * n; ++half) {
    mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t, size_t, size_t row) {
      for (size_t i = at; i < at + row; ++i) full[i] = share[i] > 0.5 ? 1 : 0, swelling[i] = 0;
    });
    mac::fill_ghosts(g, kCentre, scalar_sides_, full, *arena_);
    for (size_t k = 0; k < g.dimensions; ++k) {
      const size_t a = half % 2 == 0 ? k : g.dimensions - 1 - k;
      const auto sweep = k + 1 == g.dimensions ? mac::Sweep::last : mac::Sweep::inner;
      mac::fill_ghosts(g, kCentre, scalar_sides_, share, *arena_);
      mac::share_flux(g, a, f.u[a], part, share, flux, *arena_);
      mac::carry_share(g, a, sweep, f.u[a], part, share, flux, full, swelling, to, *arena_);
      if (carried == Carried::momentum) {
        mac::mass_flux(g, a, f.u[a], part, densities, flux, *arena_);
        mac::fill_ghosts(g, a, sides_[a], flux, *arena_);
        for (size_t c = 0; c < g.dimensions; ++c) {
          double* q = carried_[c].data.data();
          fill_component(c, q);
          mac::carry_momentum(g, c, a, sweep, u, part, densities, share, full, flux, q, moved, *arena_);
          const auto x = model_->unknown(c, 0), y = model_->unknown(c, 1), z = model_->unknown(c, 2);
          mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t kz, size_t) {
            if (j < y[0] || j >= y[1] || kz < z[0] || kz >= z[1]) return;
            std::copy_n(moved + at + x[0], x[1] - x[0], q + at + x[0]);
          });
        }
      }
      mac::for_rows(g, kCentre, *arena_,
                    [&](size_t at, size_t, size_t, size_t row) { std::copy_n(to + at, row, share + at); });
    }
  }
}

// A leapfrog: the border is half a substep behind the velocity that it is carried by. The change of the
// velocity there is kept as a rate.
void Flow::carry_second(FlowFields& f, double t, double h) {
  const mac::MacGrid& g = model_->grid;
  fill(f, t);
  note_border(f, Since::now);
  for (size_t c = 0; c < g.dimensions; ++c) mac::copy_all(g, f.u[c], carried_[c].data.data(), *arena_);
  carry_border(f, t, 0.5 * (f.border_h + h), f.second, Carried::momentum);
  f.border_h = h;
  for (size_t c = 0; c < g.dimensions; ++c) {
    double* q = carried_[c].data.data();
    mac::for_rows(g, c, *arena_, [&](size_t at, size_t, size_t, size_t row) {
      for (size_t i = at; i < at + row; ++i) q[i] = (q[i] - f.u[c][i]) / h;
    });
  }
  note_border(f, Since::before);
}

void Flow::bring_up(FlowFields& f, double t, double* share) {
  fill(f, t);
  mac::copy_all(model_->grid, f.second, share, *arena_);
  carry_border(f, t, 0.5 * f.border_h, share, Carried::volume);
}

}  // namespace truestep::grid_fluid
