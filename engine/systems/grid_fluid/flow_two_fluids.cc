// Two fluids that do not mix: one velocity and pressure for both,
//   u_t + div(u u) = -grad p / density + viscosity lap u + gravity + f,   div u = 0,
// the density of a face being the mean of the two cells', and a cell's the mean by volume. The unknown is
// p - density gravity . x, so that gravity acts only on the border, as -gravity . x grad density with x on
// the border itself: weighing the faces instead puts half of a raised border's weight a cell above it, which
// slows waves by a quarter of k dx. The border is transported sharply and conserves volume
// (kernels/mac/share.h); densities are constant within a substep. Momentum is advected by the velocity, not
// by the mass fluxes, and there is no surface tension.
#include <algorithm>
#include <cmath>

#include "engine/kernels/mac/share.h"
#include "engine/kernels/mac/upwind.h"
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
  mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t j, size_t k, size_t n) {
    for (size_t i = 0; i < n; ++i) {
      const double share = std::clamp(f.second[at + i], 0.0, 1.0);
      place[at + i] = 0, counts[at + i] = share * (1 - share);
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
      }
    }
  });
  mac::fill_ghosts(g, kCentre, scalar_sides_, place, *arena_);
  mac::fill_ghosts(g, kCentre, scalar_sides_, counts, *arena_);
  std::array<const double*, 3> weights{};
  for (size_t c = 0; c < g.dimensions; ++c) {
    double *lightness = lightness_[c].data.data(), *lift = lift_[c].data.data();
    weights[c] = lightness;
    const size_t s = g.stride(c);
    // Includes the last face of a periodic axis.
    for (size_t i = s; i < g.size(); ++i) {
      lightness[i] =
          2 * model_->def.density / (model_->density_of(f.second[i - s]) + model_->density_of(f.second[i]));
    }
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
}

void Flow::damp_at_border(const FlowFields& f, size_t c, double viscosity, double* rate) {
  const mac::MacGrid& g = model_->grid;
  const mac::ConstFields u{f.u[0], f.u[1], f.u[2]};
  const double* w = lightness_[c].data.data();
  const auto x = model_->unknown(c, 0), y = model_->unknown(c, 1), z = model_->unknown(c, 2);
  mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t k, size_t) {
    if (j < y[0] || j >= y[1] || k < z[0] || k >= z[1]) return;
    for (size_t i = at + x[0]; i < at + x[1]; ++i) {
      bool beside = false;
      for (size_t a = 0; a < g.dimensions; ++a) {
        const size_t s = g.stride(a);
        beside = beside || w[i] != w[i + s] || w[i] != w[i - s];
      }
      if (beside) rate[i] = mac::upwind_rate(g, c, u, viscosity, i);
    }
  });
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

// Half a step in the order of the axes and half in the opposite order.
void Flow::carry_second(FlowFields& f, double t, double h) {
  const mac::MacGrid& g = model_->grid;
  fill(f, t + h);
  double *to = array(0), *full = array(1), *swelling = array(2);
  // Weymouth and Yue's limit is half a cell.
  const int n = std::max(1, static_cast<int>(std::ceil(h * crossing_rate(f, t + h))));
  const double part = h / (2 * n);
  for (int half = 0; half < 2 * n; ++half) {
    mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t, size_t, size_t row) {
      for (size_t i = at; i < at + row; ++i) full[i] = f.second[i] > 0.5 ? 1 : 0, swelling[i] = 0;
    });
    for (size_t k = 0; k < g.dimensions; ++k) {
      const size_t a = half % 2 == 0 ? k : g.dimensions - 1 - k;
      mac::fill_ghosts(g, kCentre, scalar_sides_, f.second, *arena_);
      mac::carry_share(g, a, k + 1 == g.dimensions ? mac::Sweep::last : mac::Sweep::inner, f.u[a], part,
                       f.second, full, swelling, to, *arena_);
      mac::for_rows(g, kCentre, *arena_,
                    [&](size_t at, size_t, size_t, size_t row) { std::copy_n(to + at, row, f.second + at); });
    }
  }
}

}  // namespace truestep::grid_fluid
