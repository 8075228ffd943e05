#include "engine/systems/grid_fluid/steady/steady_flow.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/kernels/mac/fourth_order.h"

namespace truestep::grid_fluid {

using mac::kCentre;

namespace {
constexpr size_t kColours = 13;
// The nodes that differences reach.
constexpr std::array<std::array<int, 2>, kColours> kReach{{{0, 0},
                                                           {1, 0},
                                                           {-1, 0},
                                                           {0, 1},
                                                           {0, -1},
                                                           {1, 1},
                                                           {1, -1},
                                                           {-1, 1},
                                                           {-1, -1},
                                                           {2, 0},
                                                           {-2, 0},
                                                           {0, 2},
                                                           {0, -2}}};
size_t colour(size_t i, size_t j) {
  return (2 * i + 3 * j) % kColours;
}
// Unknowns run fastest along the axis with fewer nodes.
size_t fast_axis(const mac::MacGrid& g) {
  return g.cells[0] <= g.cells[1] ? 0 : 1;
}
size_t unknown_of(const mac::MacGrid& g, size_t i, size_t j) {
  return fast_axis(g) == 0 ? i - 1 + (g.cells[0] - 1) * (j - 1) : j - 1 + (g.cells[1] - 1) * (i - 1);
}
size_t unknowns(const mac::MacGrid& g) {
  return (g.cells[0] - 1) * (g.cells[1] - 1);
}
}  // namespace

template <class F>
void SteadyFlow::for_unknowns(const mac::MacGrid& g, F&& f) const {
  for (size_t j = 1; j < g.cells[1]; ++j) {
    for (size_t i = 1; i < g.cells[0]; ++i) f(unknown_of(g, i, j), g.at(i, j, 0), i, j);
  }
}

double SteadyFlow::bytes(const GridFluidDef& d) {
  const auto a = static_cast<double>(d.cells[0]), b = static_cast<double>(d.cells[1]);
  const double n = (a - 1) * (b - 1);
  return TileBandLu::bytes(n, 2 * (std::min(a, b) - 1)) + 8 * n * (2 * kMixed + 20);
}

void SteadyFlow::bind(const FlowModel& m, const ThreadArena& arena) {
  arena_ = &arena;
  if (model_ == &m) return;
  model_ = &m;
  levels_.clear();
  mac::MacGrid g = m.grid;
  constexpr size_t kLeast = 16;
  for (;;) {
    add_level(g);
    if (g.cells[0] % 2 || g.cells[1] % 2 || std::min(g.cells[0], g.cells[1]) < 2 * kLeast) break;
    for (size_t a = 0; a < 2; ++a) g.cells[a] /= 2, g.spacing[a] *= 2;
  }
  for (size_t a = 0; a < 2; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const auto& values = levels_[0].sides[1 - a][a][end].values;
      edges_[a][end] = {m.kinds[a][end] == SideKind::slip ? mac::Edge::Kind::slide : mac::Edge::Kind::hold,
                        values.empty() ? 0 : values[0]};
    }
  }
  const size_t size = m.grid.size(), n = unknowns(m.grid);
  for (Array* a : {&u_[0], &u_[1], &rate_[0], &rate_[1], &psi_, &start_, &trial_, &curl_}) a->assign(size, 0);
  for (auto* v : {&r_, &r2_, &step_, &last_step_, &x_, &last_x_}) v->assign(n, 0);
  step_changes_.assign(kMixed, std::vector<double>(n)), x_changes_.assign(kMixed, std::vector<double>(n));
  pressure_.emplace(m.grid, kCentre, m.mirrors(kPressure));
}

void SteadyFlow::residual(const Level& l, const double* psi, Order order, double* r) {
  const mac::MacGrid& g = l.grid;
  const mac::Fields u{u_[0].data(), u_[1].data(), nullptr};
  const mac::ConstFields known{u[0], u[1], nullptr}, rate{rate_[0].data(), rate_[1].data(), nullptr};
  const bool fourth = order == Order::scene && model_->fourth_order();
  if (fourth) {
    std::copy_n(psi, g.size(), curl_.data());
    mac::velocity_of_stream4(g, edges_, curl_.data(), u, *arena_);
  } else {
    mac::velocity_of_stream(g, psi, u, *arena_);
  }
  for (size_t c = 0; c < 2; ++c) {
    if (fourth) {
      mac::fill_ghosts4(g, c, edges_, u[c]);
    } else {
      mac::fill_ghosts(g, c, l.sides[c], u[c], *arena_);
    }
  }
  for (size_t c = 0; c < 2; ++c) {
    double* out = rate_[c].data();
    fourth ? mac::momentum_rate4(g, c, known, viscosity_, out, *arena_)
           : mac::momentum_rate(g, c, known, viscosity_, out, *arena_);
    if (l.force[c].empty()) continue;
    mac::for_rows(g, c, *arena_, [&](size_t at, size_t, size_t, size_t n) {
      for (size_t i = at; i < at + n; ++i) out[i] += l.force[c][i];
    });
  }
  if (!r) return;
  fourth ? mac::curl_of_rate4(g, rate, curl_.data(), *arena_)
         : mac::curl_of_rate(g, rate, curl_.data(), *arena_);
  for_unknowns(g, [&](size_t k, size_t at, size_t, size_t) { r[k] = curl_[at]; });
}

// -J, with 1/tau (-lap) added.
void SteadyFlow::measure_jacobian(const Level& l, const double* psi, double per_tau) {
  const mac::MacGrid& g = l.grid;
  const size_t n = unknowns(g), across = std::min(g.cells[0], g.cells[1]) - 1;
  lu_.resize(n, 2 * across);
  const double h = std::min(g.spacing[0], g.spacing[1]);
  const double size = std::max(fastest(l, psi), viscosity_ / h) * h;
  for (size_t k = 0; k < kColours; ++k) {
    for (const double sign : {1.0, -1.0}) {
      std::copy_n(psi, g.size(), trial_.data());
      for_unknowns(g, [&](size_t, size_t at, size_t i, size_t j) {
        if (colour(i, j) == k) trial_[at] += sign * size;
      });
      residual(l, trial_.data(), Order::second, sign > 0 ? r_.data() : r2_.data());
    }
    const double scale = -0.5 / size;
    for_unknowns(g, [&](size_t row, size_t, size_t i, size_t j) {
      for (const auto& [di, dj] : kReach) {
        const size_t p = i + static_cast<size_t>(di), q = j + static_cast<size_t>(dj);
        // Wraps to a large number where it would be negative.
        if (p - 1 >= g.cells[0] - 1 || q - 1 >= g.cells[1] - 1 || colour(p, q) != k) continue;
        lu_.at(row, unknown_of(g, p, q)) = scale * (r_[row] - r2_[row]);
        break;
      }
    });
  }
  if (per_tau == 0) return;
  const double along = per_tau / (g.spacing[0] * g.spacing[0]), up = per_tau / (g.spacing[1] * g.spacing[1]);
  for_unknowns(g, [&](size_t row, size_t, size_t i, size_t j) {
    lu_.at(row, row) += 2 * (along + up);
    if (i > 1) lu_.at(row, unknown_of(g, i - 1, j)) -= along;
    if (i + 1 < g.cells[0]) lu_.at(row, unknown_of(g, i + 1, j)) -= along;
    if (j > 1) lu_.at(row, unknown_of(g, i, j - 1)) -= up;
    if (j + 1 < g.cells[1]) lu_.at(row, unknown_of(g, i, j + 1)) -= up;
  });
}

double SteadyFlow::fastest(const Level& l, const double* psi) const {
  const mac::MacGrid& g = l.grid;
  double most = 0;
  for (size_t j = 0; j < g.cells[1]; ++j) {
    for (size_t i = 0; i < g.cells[0]; ++i) {
      const double* p = psi + g.at(i, j, 0);
      most = std::max(
          {most, std::abs(p[1] - p[0]) / g.spacing[0], std::abs(p[g.stride(1)] - p[0]) / g.spacing[1]});
    }
  }
  return most;
}

void SteadyFlow::scatter(const Level& l, const double* x, double* psi) const {
  for_unknowns(l.grid, [&](size_t k, size_t at, size_t, size_t) { psi[at] = x[k]; });
}

// Anderson mixing: x_ becomes x + step minus the combination of the last rounds' changes that cancels most of
// the step, from normal equations with a slightly raised diagonal.
void SteadyFlow::mix(size_t round, size_t n) {
  if (round > 0) {
    auto &ds = step_changes_[(round - 1) % kMixed], &dx = x_changes_[(round - 1) % kMixed];
    for (size_t i = 0; i < n; ++i) ds[i] = step_[i] - last_step_[i], dx[i] = x_[i] - last_x_[i];
  }
  std::copy_n(x_.data(), n, last_x_.data()), std::copy_n(step_.data(), n, last_step_.data());
  const size_t m = std::min(round, kMixed);
  double a[kMixed][kMixed], b[kMixed];
  for (size_t p = 0; p < m; ++p) {
    const auto product = [&](const std::vector<double>& other) {
      return arena_->sum_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t i = begin; i < end; ++i) sum += step_changes_[p][i] * other[i];
        return sum;
      });
    };
    b[p] = product(step_);
    for (size_t q = 0; q <= p; ++q) a[p][q] = a[q][p] = product(step_changes_[q]);
  }
  for (size_t p = 0; p < m; ++p) a[p][p] *= 1 + 1e-12;
  // Cholesky factorization; a linearly dependent row is left out.
  for (size_t p = 0; p < m; ++p) {
    for (size_t q = 0; q <= p; ++q) {
      double sum = a[p][q];
      for (size_t k = 0; k < q; ++k) sum -= a[p][k] * a[q][k];
      if (p == q) {
        a[p][p] = sum > 1e-12 * a[p][p] ? std::sqrt(sum) : 0;
      } else {
        a[p][q] = a[q][q] > 0 ? sum / a[q][q] : 0;
      }
    }
  }
  for (size_t p = 0; p < m; ++p) {
    for (size_t k = 0; k < p; ++k) b[p] -= a[p][k] * b[k];
    b[p] = a[p][p] > 0 ? b[p] / a[p][p] : 0;
  }
  for (size_t p = m; p-- > 0;) {
    for (size_t k = p + 1; k < m; ++k) b[p] -= a[k][p] * b[k];
    b[p] = a[p][p] > 0 ? b[p] / a[p][p] : 0;
  }
  for (size_t i = 0; i < n; ++i) {
    double x = x_[i] + step_[i];
    for (size_t p = 0; p < m; ++p) x -= b[p] * (x_changes_[p][i] + step_changes_[p][i]);
    x_[i] = x;
  }
}

double SteadyFlow::fastest_side(const Level& l) {
  double speed = 0;
  for (const auto& component : l.sides) {
    for (const auto& axis : component) {
      for (const auto& side : axis) {
        for (const double v : side.values) speed = std::max(speed, std::abs(v));
      }
    }
  }
  return speed;
}

SteadyFlow::Outcome SteadyFlow::solve_level(const Level& l, double* psi, From from, double tolerance,
                                            int most) {
  constexpr size_t kPatience = 3;
  const mac::MacGrid& g = l.grid;
  const size_t n = unknowns(g);
  const auto rms = [&] {
    double sum = 0;
    for (size_t i = 0; i < n; ++i) sum += r_[i] * r_[i];
    return std::sqrt(sum / static_cast<double>(n));
  };
  for_unknowns(g, [&](size_t k, size_t at, size_t, size_t) { x_[k] = psi[at]; });
  residual(l, psi, Order::scene, r_.data());
  const double start = rms();
  Outcome out;
  if (start == 0) return {.found = true};
  // From rest: a step of pseudo time in which the fastest side crosses half the box, as long as R allows it.
  const double speed = fastest_side(l);
  const double length = std::min(g.extent(0), g.extent(1));
  const double first = from == From::psi ? 0 : 2 * std::max(speed / length, viscosity_ / (length * length));
  double left = start, per_tau = first;
  while (out.iterations < most) {
    if (first > 0) {
      const double fallen = left / start;
      per_tau = fallen < 1e-6 ? 0 : first * fallen * std::sqrt(std::sqrt(fallen));
    }
    measure_jacobian(l, psi, per_tau);
    if (!lu_.factor(*arena_)) return out;
    double reference = HUGE_VAL;
    for (size_t round = 0; out.iterations < most; ++round) {
      residual(l, psi, Order::scene, r_.data());
      std::copy_n(r_.data(), n, step_.data());
      lu_.solve(step_.data());
      ++out.iterations;
      std::fill_n(trial_.data(), g.size(), 0.0);
      scatter(l, step_.data(), trial_.data());
      out.change = fastest(l, trial_.data()) / std::max(fastest(l, psi), 1e-300);
      if (!std::isfinite(out.change)) return out;
      mix(round, n);
      scatter(l, x_.data(), psi);
      if (per_tau == 0 && out.change <= tolerance) {
        out.found = true;
        return out;
      }
      // Factors that no longer halve the residual every second round are discarded.
      if (per_tau > 0) break;
      if (round % kPatience == kPatience - 1) {
        if (!(out.change < 0.25 * reference)) break;
        reference = out.change;
      }
    }
    residual(l, psi, Order::scene, r_.data());
    left = rms();
    // Far from a solution Newton's method diverges: pseudo time gets closer first.
    constexpr double kFurther = 10;
    if (!std::isfinite(left) || (first == 0 && left > kFurther * start)) return out;
  }
  return out;
}

// By Newton's method alone; if that fails, with pseudo time from the same start, which psi keeps if both
// fail.
SteadyFlow::Outcome SteadyFlow::solve_from(const Level& l, double* psi, double tolerance) {
  constexpr int kMost = 50;
  std::copy_n(psi, l.grid.size(), start_.data());
  Outcome out = solve_level(l, psi, From::psi, tolerance, kMost);
  if (out.found) return out;
  std::copy_n(start_.data(), l.grid.size(), psi);
  out = solve_level(l, psi, From::rest, tolerance, kMost);
  if (!out.found) std::copy_n(start_.data(), l.grid.size(), psi);
  return out;
}

SteadyFlow::Outcome SteadyFlow::solve(double* psi, double viscosity, From from, double tolerance) {
  viscosity_ = viscosity;
  constexpr double kRough = 1e-3;
  // A coarse grid with a cell Reynolds number above this gives no useful start: its viscosity is raised, and
  // less so on each finer grid (16 cells across the cavity can do 1024).
  constexpr double kCellReynolds = 64;
  constexpr int kMostFromRest = 150;
  if (from == From::psi) return solve_from(levels_[0], psi, tolerance);
  for (size_t k = levels_.size(); k-- > 0;) {
    const Level& l = levels_[k];
    double* now = k == 0 ? psi : psi_.data();
    if (k + 1 == levels_.size()) {
      std::copy_n(l.boundary.data(), l.grid.size(), now);
    } else {
      std::copy_n(psi_.data(), levels_[k + 1].grid.size(), trial_.data());
      prolong(levels_[k + 1], trial_.data(), l, now);
      // The sides are evaluated on this grid.
      for_unknowns(l.grid, [&](size_t u, size_t at, size_t, size_t) { x_[u] = now[at]; });
      std::copy_n(l.boundary.data(), l.grid.size(), now);
      scatter(l, x_.data(), now);
    }
    if (k > 0) {
      const double spacing = std::max(l.grid.spacing[0], l.grid.spacing[1]);
      viscosity_ = std::max(viscosity, fastest_side(l) * spacing / kCellReynolds);
    } else {
      viscosity_ = viscosity;
    }
    const double wanted = k == 0 ? tolerance : kRough;
    const bool coarsest = k + 1 == levels_.size();
    const Outcome out =
        coarsest ? solve_level(l, now, From::rest, wanted, kMostFromRest) : solve_from(l, now, wanted);
    if (k == 0) return out;
  }
  return {};
}

void SteadyFlow::fields(const double* psi, FlowFields& f) {
  const mac::MacGrid& g = model_->grid;
  const Level& l = levels_[0];
  residual(l, psi, Order::scene, nullptr);
  for (size_t c = 0; c < 2; ++c) std::copy_n(u_[c].data(), g.size(), f.u[c]);
  // The pressure balances the acceleration; on the sides there is none.
  for (size_t c = 0; c < 2; ++c) {
    mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t, size_t n) {
      double* r = rate_[c].data() + at;
      if (c == 0) r[0] = r[n - 1] = 0;
      if (c == 1 && (j == 0 || j == g.cells[1])) std::fill_n(r, n, 0.0);
    });
  }
  std::fill_n(f.pressure, g.size(), 0.0);
  mac::divergence(g, {rate_[0].data(), rate_[1].data(), nullptr}, f.pressure, *arena_);
  pressure_->solve(0, -1, f.pressure, *arena_);
}

double SteadyFlow::largest_divergence(const FlowFields& f) const {
  const mac::MacGrid& g = model_->grid;
  const mac::ConstFields u{f.u[0], f.u[1], nullptr};
  double most = 0;
  for (size_t j = 1; j + 1 < g.cells[1]; ++j) {
    for (size_t i = 1; i + 1 < g.cells[0]; ++i)
      most = std::max(most, std::abs(mac::divergence4_at(g, u, g.at(i, j, 0))));
  }
  return most;
}

}  // namespace truestep::grid_fluid
