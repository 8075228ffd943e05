#include "engine/systems/grid_fluid/flow.h"

#include <algorithm>
#include <cmath>

#include "engine/kernels/mac/fourth_order.h"

namespace truestep::grid_fluid {

using mac::kCentre;
using mac::Mirror;

void Flow::bind(const FlowModel& m, const ThreadArena& arena) {
  arena_ = &arena;
  if (model_ == &m) return;
  model_ = &m;
  const auto set = [&](mac::Sides& sides, size_t place) {
    const auto mirrors = m.mirrors(place);
    for (size_t a = 0; a < 3; ++a) {
      for (size_t end = 0; end < 2; ++end) sides[a][end].mirror = mirrors[a][end];
    }
  };
  using Differences = lattice::StaggeredSolver::Differences;
  const bool fourth = m.fourth_order();
  for (size_t c = 0; c < m.grid.dimensions; ++c) {
    set(sides_[c], c);
    viscous_[c].emplace(m.grid, c, m.mirrors(c), fourth ? Differences::fourth : Differences::second);
    force_[c].clear();
  }
  source_.clear();
  set(scalar_sides_, kCentre), set(pressure_sides_, kPressure);
  solids_.bind(m);
  if (m.two_fluids()) {
    cut_pressure_.emplace(m.grid, m.mirrors(kPressure));
    for (size_t c = 0; c < m.grid.dimensions; ++c) {
      for (Buffer* b : {&lightness_[c], &lift_[c], &carried_[c]}) b->data.assign(m.grid.size(), 0);
      beside_border_[c].assign(m.grid.size(), 0);
    }
    if (m.two_viscosities()) fluidity_.data.assign(m.grid.size(), 0);
  } else if (m.solids.any()) {
    for (size_t c = 0; c < m.grid.dimensions && m.texts.obstacles_move; ++c)
      were_inside_[c].reserve(solids_->inside[c].capacity());
    cut_pressure_.emplace(m.grid, m.mirrors(kPressure), m.solids.open);
  } else {
    pressure_.emplace(m.grid, kCentre, m.mirrors(kPressure),
                      fourth ? Differences::fourth_divergence : Differences::second);
  }
  if (m.def.scalar && m.def.scalar->diffusivity > 0) scalar_.emplace(m.grid, kCentre, m.mirrors(kCentre));
  for (Buffer& b : arrays_) b.data.assign(m.grid.size(), 0);
  sides_time_ = -1;
}

template <class F>
void Flow::for_side(size_t a, F&& f) const {
  const mac::MacGrid& g = model_->grid;
  const size_t first = a == 0 ? 1 : 0, second = a == 2 ? 1 : 2;
  const size_t block = std::max<size_t>(1, kBlockRows / g.cells[first]);
  arena_->for_blocks(g.cells[second], block, [&](size_t begin, size_t last) {
    for (size_t q = begin; q < last; ++q) {
      const size_t row = g.base() + (second < g.dimensions ? q * g.stride(second) : 0);
      for (size_t p = 0; p < g.cells[first]; ++p) f(row + p * g.stride(first), q);
    }
  });
}

void Flow::sides_at(double t) {
  if (sides_time_ == t || (sides_time_ >= 0 && !model_->texts.sides_move)) return;
  sides_time_ = t, side_rate_ = 0;
  const mac::MacGrid& g = model_->grid;
  for (size_t c = 0; c < g.dimensions; ++c) {
    for (size_t a = 0; a < g.dimensions; ++a) {
      for (size_t end = 0; end < 2; ++end) {
        const SideKind k = model_->kinds[a][end];
        mac::SideValues& side = sides_[c][a][end];
        if (side.mirror != Mirror::given || model_->texts.sides[a][end][c].zero) continue;
        // Walls move only along themselves.
        if (k == SideKind::wall && a == c) continue;
        model_->texts.sample_side(g, a, end, c, t, side.values);
        double most = 0;
        for (const double v : side.values) most = std::max(most, std::abs(v));
        side_rate_ = std::max(side_rate_, most / g.spacing[c]);
      }
    }
  }
}

void Flow::fill_component(size_t c, double* u) {
  mac::fill_ghosts(model_->grid, c, sides_[c], u, *arena_);
}

void Flow::fill(FlowFields& f, double t) {
  sides_at(t);
  for (size_t c = 0; c < model_->grid.dimensions; ++c) fill_component(c, f.u[c]);
}

double Flow::crossing_rate(FlowFields& f, double t) {
  sides_at(t);
  const mac::MacGrid& g = model_->grid;
  double sum = 0;
  for (size_t c = 0; c < g.dimensions; ++c) {
    const double most = mac::largest_of_rows(g, c, *arena_, [&](size_t at, size_t n) {
      const double* u = f.u[c] + at;
      double low = 0, high = 0;
      for (size_t i = 0; i < n; ++i) low = u[i] < low ? u[i] : low, high = u[i] > high ? u[i] : high;
      return std::max(high, -low);
    });
    sum += most / g.spacing[c];
  }
  if (model_->texts.obstacles_move) {
    place_obstacles(t);
    sum = std::max(sum, solids_.crossing_rate());
  }
  return std::max(sum, side_rate_);
}

bool Flow::implicit(double viscosity, double h) const {
  const GridFluidDef& d = model_->def;
  if (viscosity == 0 || model_->two_viscosities()) return false;
  if (d.advection != GridFluidDef::Advection::central) return true;
  if (model_->sharp_walls()) return false;
  if (d.viscous != GridFluidDef::Viscous::automatic) return d.viscous == GridFluidDef::Viscous::implicit;
  double rate = 0;
  for (size_t a = 0; a < model_->grid.dimensions; ++a)
    rate += 4 / (model_->grid.spacing[a] * model_->grid.spacing[a]);
  // Stability with rotating eddies: half of the real axis that the method allows.
  const double held = d.stepping == GridFluidDef::Stepping::rk3 ? 1.25 : 0.5;
  return viscosity * rate * h > held;
}

// The last face before an outflow is advected unchanged.
void Flow::open_sides(size_t c, double* u) {
  const mac::MacGrid& g = model_->grid;
  const size_t s = g.stride(c);
  for (size_t end = 0; end < 2; ++end) {
    if (model_->kinds[c][end] != SideKind::outflow) continue;
    const size_t side = end == 0 ? 0 : g.cells[c], inside = end == 0 ? 1 : g.cells[c] - 1;
    for_side(c, [&](size_t at, size_t) { u[at + side * s] = u[at + inside * s]; });
  }
}

void Flow::add_force(FlowFields& f, double t, size_t c, double factor, double* to) {
  const mac::MacGrid& g = model_->grid;
  const Program& program = model_->texts.force[c];
  if (!program.zero) {
    std::vector<double>& force = force_[c];
    if (force.empty() || program.time) {
      force.resize(g.size());
      model_->texts.sample(program, g, c, t, force.data(), *arena_);
    }
    mac::for_rows(g, c, *arena_, [&](size_t at, size_t, size_t, size_t n) {
      for (size_t i = 0; i < n; ++i) to[at + i] += factor * force[at + i];
    });
  }
  const Vec3& gravity = model_->gravity;
  const double along = c == 0 ? gravity.x : c == 1 ? gravity.y : gravity.z;
  if (f.second) add_weight(c, factor, to);
  if (!f.scalar || along == 0 || model_->def.scalar->expansion == 0) return;
  const double rise = -0.5 * factor * along * model_->def.scalar->expansion;
  const size_t s = g.stride(c);
  mac::for_rows(g, c, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    const double* q = f.scalar + at;
    for (size_t i = 0; i < n; ++i) to[at + i] += rise * ((q - s)[i] + q[i]);
  });
}

// Transforms assume mirror images beyond walls, the differences parabolas, whose friction is larger: solves
// by transforms damp the modes of the wall too little, by up to m = 4/3 (in corners 5/3), which long steps
// would amplify and short ones not resolve. With the difference on the right-hand side of two more solves,
// weighted by 1 and 1 / m, modes lack 0 to 0.004 of their change (in corners 0.03): never less than 0, so
// that steps of any length are stable, and nothing where the walls are not felt.
void Flow::diffuse(size_t c, double amount, double* change) {
  const mac::MacGrid& g = model_->grid;
  const double walls = static_cast<double>(g.dimensions) - 1;  // that meet in a corner and are parallel to c
  bool any = false;
  for (size_t a = 0; a < g.dimensions; ++a) {
    for (size_t end = 0; end < 2 && a != c; ++end) any = any || sides_[c][a][end].mirror == Mirror::given;
  }
  if (!any) return viscous_[c]->solve(1, amount, change, *arena_);
  double *once = array(9), *twice = array(c);
  mac::for_rows(g, c, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    std::copy_n(change + at, n, once + at), std::copy_n(change + at, n, twice + at);
  });
  viscous_[c]->solve(1, amount, once, *arena_);
  mac::add_wall_curvature(g, c, sides_[c], once, amount, twice, *arena_);
  viscous_[c]->solve(1, amount, twice, *arena_);
  mac::add_wall_curvature(g, c, sides_[c], twice, amount, change, *arena_);
  viscous_[c]->solve(1, amount, change, *arena_);
  const double weight = 1 / (1 + walls / 3);
  mac::for_rows(g, c, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) change[i] = twice[i] + weight * (change[i] - twice[i]);
  });
}

void Flow::stage(FlowFields& f, double t, double h, const Weights& w, bool implicit) {
  const mac::MacGrid& g = model_->grid;
  const mac::ConstFields u{f.u[0], f.u[1], f.u[2]};
  fill(f, t);
  const bool walls = model_->sharp_walls(), fourth = model_->fourth_order();
  if (walls) {
    place_obstacles(t);
    extend_into_solids(f, At::centre);
  }
  mac::fill_ghosts(g, kCentre, pressure_sides_, f.pressure, *arena_);
  if (f.scalar) mac::fill_ghosts(g, kCentre, scalar_sides_, f.scalar, *arena_);
  for (size_t c = 0; c < g.dimensions; ++c) {
    double *now = array(c), *before = f.rate[c] ? f.rate[c] : array(3 + c);
    const double viscosity = implicit ? 0 : f.viscosity;
    fourth ? mac::momentum_rate4(g, c, u, viscosity, now, *arena_)
           : mac::momentum_rate(g, c, u, f.second ? 0 : viscosity, now, *arena_);
    if (f.second) {
      convect_at_border(c, now);
      add_viscosity(f, c, viscosity, now);
    }
    add_force(f, t, c, 1, now);
    double* change = array(6 + c);
    const double a = h * w.gamma, b = h * w.zeta;
    mac::for_rows(g, c, *arena_, [&](size_t at, size_t, size_t, size_t n) {
      double *to = change + at, *x = now + at, *y = before + at;
      if (b == 0) {
        for (size_t i = 0; i < n; ++i) to[i] = a * x[i], y[i] = x[i];
      } else {
        for (size_t i = 0; i < n; ++i) to[i] = a * x[i] + b * y[i], y[i] = x[i];
      }
    });
    const double alpha = h * w.alpha;
    if (f.second) {
      subtract_pressure(f, c, f.pressure, 2 * alpha, change);
    } else {
      fourth ? mac::subtract_gradient4(g, c, f.pressure, 2 * alpha, change, *arena_)
             : mac::subtract_gradient(g, c, f.pressure, 2 * alpha, change, *arena_);
    }
    if (implicit) {
      const double amount = 2 * alpha * f.viscosity;
      fourth ? mac::add_laplacian4(g, c, f.u[c], amount, change, *arena_)
             : mac::add_laplacian(g, c, f.u[c], amount, change, *arena_);
      diffuse(c, alpha * f.viscosity, change);
    }
    if (walls) hold_solids(f, c, change);
  }
  for (size_t c = 0; c < g.dimensions; ++c) {
    const auto x = model_->unknown(c, 0), y = model_->unknown(c, 1), z = model_->unknown(c, 2);
    const double* change = array(6 + c);
    mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t k, size_t) {
      if (j < y[0] || j >= y[1] || k < z[0] || k >= z[1]) return;
      for (size_t i = x[0]; i < x[1]; ++i) f.u[c][at + i] += change[at + i];
    });
  }
  project(f, t, 2 * h * w.alpha);
}

// If no side is open, the discretized inflow and outflow must be equal: the difference is spread over the
// faces of the sides with given velocities.
void Flow::balance(FlowFields& f) {
  const mac::MacGrid& g = model_->grid;
  if (model_->open) return;
  double net = 0, area = 0;
  const auto for_inflows = [&](auto&& visit) {
    for (size_t a = 0; a < g.dimensions; ++a) {
      for (size_t end = 0; end < 2; ++end) {
        if (model_->kinds[a][end] == SideKind::inflow) visit(a, end == 0 ? 0 : g.cells[a] * g.stride(a), end);
      }
    }
  };
  for_inflows([&](size_t a, size_t side, size_t end) {
    // Sums of rows, then their sum, in a fixed order.
    const double face = g.cell_volume() / g.spacing[a], outwards = end == 0 ? -1 : 1;
    const size_t first = a == 0 ? 1 : 0, second = a == 2 ? 1 : 2;
    row_sums_.assign(g.cells[second], 0);
    for_side(a, [&](size_t at, size_t q) { row_sums_[q] += f.u[a][at + side]; });
    for (const double sum : row_sums_) net -= outwards * face * sum;
    area += face * static_cast<double>(g.cells[first] * g.cells[second]);
  });
  const double add = area > 0 ? net / area : 0;
  if (add == 0) return;
  for_inflows([&](size_t a, size_t side, size_t end) {
    const double change = end == 0 ? -add : add;
    for_side(a, [&](size_t at, size_t) { f.u[a][at + side] += change; });
  });
}

void Flow::project(FlowFields& f, double t, double h) {
  const mac::MacGrid& g = model_->grid;
  fill(f, t + h);
  for (size_t c = 0; c < g.dimensions; ++c) open_sides(c, f.u[c]);
  balance(f);
  double* phi = array(9);
  if (f.second) {
    mac::divergence(g, {f.u[0], f.u[1], f.u[2]}, phi, *arena_);
    f.solved = cut_pressure_->solve(phi, model_->def.tolerance, *arena_);
  } else if (cut_pressure_) {
    move_obstacles(f, t + h);
    model_->sharp_walls() ? extend_into_solids(f, At::open_part) : stop_in_solids(f);
    divergence_between_solids(f, phi);
    f.solved = cut_pressure_->solve(phi, model_->def.tolerance, *arena_);
  } else {
    const mac::ConstFields u{f.u[0], f.u[1], f.u[2]};
    if (model_->fourth_order()) {
      // Mirrors the balanced values beyond the sides.
      for (size_t c = 0; c < g.dimensions; ++c) fill_component(c, f.u[c]);
      mac::divergence4(g, u, phi, *arena_);
    } else {
      mac::divergence(g, u, phi, *arena_);
    }
    // -lap phi = -div u: the solver's step is -1, its shift 0.
    pressure_->solve(0, -1, phi, *arena_);
  }
  mac::fill_ghosts(g, kCentre, pressure_sides_, phi, *arena_);
  for (size_t c = 0; c < g.dimensions; ++c) {
    if (model_->fourth_order()) {
      mac::subtract_gradient4(g, c, phi, 1, f.u[c], *arena_);
      continue;
    }
    subtract_pressure(f, c, phi, 1, f.u[c]);
    if (model_->solids.any()) settle_shut_faces(f, c, phi);
  }
  if (h > 0) {
    const double per = 1 / h;
    mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t, size_t, size_t n) {
      for (size_t i = 0; i < n; ++i) f.pressure[at + i] += per * phi[at + i];
    });
    if (model_->texts.obstacles_move) extend_pressure(f);
  }
}

// The scalar in two halves around the flow, the second with the axes in the opposite order, which is of
// second order (Strang 1968) and lets buoyancy oscillate without growing. What moving obstacles have done to
// the velocity is known after the flow only.
void Flow::substep(FlowFields& f, double t, double h) {
  const bool before = f.scalar && !model_->texts.obstacles_move;
  if (before) carry(f, t, 0.5 * h, Axes::forwards);
  if (f.second) carry_second(f, t, h);
  weigh(f);
  if (model_->def.advection != GridFluidDef::Advection::central) {
    along_paths(f, t, h);
  } else if (model_->def.stepping == GridFluidDef::Stepping::rk3) {
    constexpr Weights kStages[] = {
        {8.0 / 15, 0, 4.0 / 15}, {5.0 / 12, -17.0 / 60, 1.0 / 15}, {3.0 / 4, -5.0 / 12, 1.0 / 6}};
    const bool implicit = this->implicit(f.viscosity, h);
    double at = 0;
    for (const Weights& w : kStages) {
      stage(f, t + at * h, h, w, implicit);
      at += 2 * w.alpha;
    }
  } else {
    const double r = f.last_h > 0 ? h / f.last_h : 0;
    stage(f, t, h, {1 + 0.5 * r, -0.5 * r, 0.5}, implicit(f.viscosity, h));
    f.last_h = h;
  }
  if (f.scalar && !before) carry(f, t + h, 0.5 * h, Axes::forwards);
  if (f.scalar) carry(f, t + h, 0.5 * h, Axes::backwards);
}

}  // namespace truestep::grid_fluid
