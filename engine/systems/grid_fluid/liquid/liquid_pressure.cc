// The grid's part of a liquid's step: velocities on faces, surface, pressure, and the displacement that
// undoes compression.
#include <algorithm>
#include <cmath>

#include "engine/systems/grid_fluid/liquid/liquid_flow.h"

namespace truestep::grid_fluid {

using mac::kCentre;

// Momentum over mass; faces that no particle reaches from their neighbours; external forces.
void LiquidFlow::settle_faces(double t, double h) {
  const mac::MacGrid& g = model_->grid;
  const double along[] = {model_->gravity.x, model_->gravity.y, model_->gravity.z};
  for (size_t c = 0; c < g.dimensions; ++c) {
    double* u = u_[c].data();
    const double* mass = mass_[c].data();
    uint8_t* known = known_[c].data();
    for_faces(c, [&](size_t at, size_t, int side) {
      known[at] = side || mass[at] > 0;
      u[at] = mass[at] > 0 ? u[at] / mass[at] : 0;
    });
    mac::extrapolate(g, c, 2, u, known, work_.data(), fresh_.data(), *arena_);
    fill_velocity(c, u);
    given_.hold(c, u);
    mac::copy_all(g, u, before_[c].data(), *arena_);
    const Program& program = model_->texts.force[c];
    std::vector<double>& force = force_[c];
    if (!program.zero && (force.empty() || program.time)) {
      force.resize(g.size());
      model_->texts.sample(program, g, c, t, force.data(), *arena_);
    }
    for_faces(c, [&](size_t at, size_t, int) { u[at] += h * (along[c] + (program.zero ? 0 : force[at])); });
    given_.hold(c, u);
  }
}

void LiquidFlow::find_surface(LiquidFields& f) {
  const mac::MacGrid& g = model_->grid;
  // A cell almost filled by an obstacle says little about the liquid around it.
  constexpr double kLeastRoom = 0.2;
  const double *room = room_.data(), least = kLeastRoom * room_.whole();
  mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) {
      f.fill[i] = f.fill[i] / std::max(room[i], least);
      depth_[i] = mac::depth_of_fill(f.fill[i]);
      liquid_[i] = depth_[i] > 0;
    }
  });
  mac::wrap_periodic(g, depth_.data(), *arena_), mac::wrap_periodic(g, liquid_.data(), *arena_);
  for (size_t c = 0; c < g.dimensions; ++c)
    mac::surface_faces(g, c, liquid_.data(), depth_.data(), factor_[c].data(), *arena_), open_sides(c);
  if (solids_->any()) {
    for (size_t c = 0; c < g.dimensions; ++c) {
      // Between the matrix and the pressure differences: open fractions of faces belong in the matrix alone.
      const double* open = solids_->open[c].data();
      for_faces(c, [&](size_t at, size_t, int) { shift_[c][at] = factor_[c][at] * open[at]; });
      mac::wrap_periodic(g, shift_[c].data(), *arena_);
    }
  }
  for (size_t c = 0; c < g.dimensions; ++c) mac::wrap_periodic(g, factor_[c].data(), *arena_);
  const auto& open = solids_->any() ? shift_ : factor_;
  solver_->set({open[0].data(), open[1].data(), open[2].data()}, liquid_.data(), *arena_);
}

// The pressure is 0 on sides that are an outflow; faces whose velocity is given feel none.
void LiquidFlow::open_sides(size_t c) {
  const mac::MacGrid& g = model_->grid;
  double* factor = factor_[c].data();
  for (size_t end = 0; end < 2; ++end) {
    if (model_->kinds[c][end] != SideKind::outflow) continue;
    const size_t s = g.stride(c), side = (mac::kGhosts + (end == 0 ? 0 : g.cells[c])) * s;
    mac::for_lines(g, c, *arena_, [&](size_t line) {
      const size_t at = line + side;
      factor[at] = liquid_[end == 0 ? at : at - s] ? 1 : 0;
    });
  }
  given_.shut(c, factor);
}

void LiquidFlow::apply_viscosity(double h, LiquidReport& report) {
  const mac::MacGrid& g = model_->grid;
  for (size_t c = 0; c < g.dimensions; ++c) {
    for (const Solids::Face& face : solids_->shut[c]) {
      if (solids_->open[c][face.at] == 0) u_[c][face.at] = solids_.velocity(face, c);
    }
    const auto out = viscosity_.solve(c, liquid_.data(), depth_.data(), h * model_->def.viscosity,
                                      model_->def.tolerance, u_[c].data(), *arena_);
    report.viscosity_iterations = std::max(report.viscosity_iterations, out.iterations);
    mac::wrap_periodic(g, u_[c].data(), *arena_);
  }
}

void LiquidFlow::project(LiquidFields& f, double h, LiquidReport& report) {
  const mac::MacGrid& g = model_->grid;
  double* phi = f.pressure;
  const bool solid = solids_->any(), moves = model_->texts.obstacles_move;
  for (size_t c = 0; c < g.dimensions; ++c) {
    // Sides stop liquid that moves outwards; drops may leave them.
    for_faces(c, [&](size_t at, size_t low, int side) {
      if (side == 0) return;
      const bool away = u_[c][at] * side > 0 && mass_[c][at] > 0;
      if (liquid_[at] || liquid_[low] || !away) u_[c][at] = 0;
    });
    given_.hold(c, u_[c].data());
    mac::wrap_periodic(g, u_[c].data(), *arena_);
  }
  // Flow through a face: liquid through its open fraction, the obstacle through the rest.
  std::array<const double*, 3> passing{};
  for (size_t c = 0; c < g.dimensions; ++c) {
    passing[c] = u_[c].data();
    if (!solid) continue;
    const double* open = solids_->open[c].data();
    for_faces(c, [&](size_t at, size_t, int) { shift_[c][at] = open[at] * u_[c][at]; });
    for (const Solids::Face& face : solids_->shut[c])
      shift_[c][face.at] += moves ? (1 - open[face.at]) * solids_.velocity(face, c) : 0;
    mac::wrap_periodic(g, shift_[c].data(), *arena_);
    passing[c] = shift_[c].data();
  }
  mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) {
      double sum = 0;
      for (size_t c = 0; c < g.dimensions; ++c)
        sum += (passing[c][i + g.stride(c)] - passing[c][i]) / g.spacing[c];
      phi[i] = liquid_[i] ? sum : 0;
    }
  });
  given_.take_sources(liquid_.data(), phi);
  report.pressure = solver_->solve(phi, model_->def.tolerance, *arena_);
  mac::fill_ghosts(g, kCentre, cell_sides_, phi, *arena_);
  for (size_t c = 0; c < g.dimensions; ++c) {
    const double scale = 1 / g.spacing[c];
    const double* open = solid ? solids_->open[c].data() : nullptr;
    for_faces(c, [&](size_t at, size_t low, int side) {
      const bool wet = liquid_[at] || liquid_[low];
      if (!side) u_[c][at] -= scale * factor_[c][at] * (phi[at] - phi[low]);
      if (wet && open && open[at] == 0) u_[c][at] = 0;
      known_[c][at] = side || wet;
    });
    for (const Solids::Face& face : solids_->shut[c]) {
      if (moves && open[face.at] == 0 && known_[c][face.at]) u_[c][face.at] = solids_.velocity(face, c);
    }
    accelerate_beside(c);
    given_.hold(c, u_[c].data()), given_.mark(c, known_[c].data());
  }
  const double per = 1 / h;
  mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) phi[i] *= per;
  });
}

// Faces reached by particles but not by the pressure: next to the liquid they accelerate as it does
// (otherwise a still surface would rain), further away they fall freely.
void LiquidFlow::accelerate_beside(size_t c) {
  const mac::MacGrid& g = model_->grid;
  double *change = shift_[c].data(), *u = u_[c].data();
  uint8_t* known = known_[c].data();
  const double *before = before_[c].data(), *mass = mass_[c].data();
  const double* open = solids_->any() ? solids_->open[c].data() : nullptr;
  for_faces(c, [&](size_t at, size_t, int) { change[at] = known[at] ? u[at] - before[at] : 0; });
  mac::extrapolate(g, c, 1, change, known, work_.data(), fresh_.data(), *arena_);
  // Faces found by the last layer.
  for_faces(c, [&](size_t at, size_t low, int side) {
    if (side || liquid_[at] || liquid_[low]) return;
    if (fresh_[at]) u[at] = before[at] + change[at];
    known[at] = mass[at] > 0 && !(open && open[at] == 0);
  });
}

// shift_ becomes the displacement across each face, in cells.
void LiquidFlow::take_back_compression(LiquidFields& f, LiquidReport& report) {
  const mac::MacGrid& g = model_->grid;
  double* psi = work_.data();
  const double* room = room_.data();
  double sum = 0, most = 0, cells = 0;
  // A cell next to the surface is naturally less than full; inside, gaps are closed again.
  mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) {
      bool inside = liquid_[i];
      for (size_t a = 0; a < g.dimensions && inside; ++a) {
        for (const size_t m : {i - g.stride(a), i + g.stride(a)})
          inside = inside && (liquid_[m] || room[m] == 0);
      }
      constexpr double kMost = 0.5;
      const double excess = f.fill[i] - 1;
      psi[i] = !liquid_[i] ? 0 : -std::clamp(excess, inside ? -kMost : 0, kMost);
    }
  });
  // Sums of rows, then their sum, in a fixed order.
  const size_t rows = g.cells[1] * g.cells[2];
  mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t j, size_t k, size_t n) {
    Excess& row = excess_[j + g.cells[1] * k];
    row = {};
    for (size_t i = at; i < at + n; ++i) {
      if (!liquid_[i]) continue;
      const double excess = std::max(f.fill[i] - 1, 0.0);
      row.sum += excess, row.most = std::max(row.most, excess), row.cells += 1;
    }
  });
  for (size_t r = 0; r < rows; ++r)
    sum += excess_[r].sum, most = std::max(most, excess_[r].most), cells += excess_[r].cells;
  report.mean_compression = cells > 0 ? sum / cells : 0, report.max_compression = most;
  constexpr double kTolerance = 1e-2, kFarthest = 0.25;
  report.density = solver_->solve(psi, kTolerance, *arena_);
  mac::fill_ghosts(g, kCentre, cell_sides_, psi, *arena_);
  for (size_t c = 0; c < g.dimensions; ++c) {
    const double scale = 1 / (g.spacing[c] * g.spacing[c]);
    const double* open = solids_->any() ? solids_->open[c].data() : nullptr;
    for_faces(c, [&](size_t at, size_t low, int side) {
      const bool shut = side || (open && open[at] == 0);
      shift_[c][at] =
          shut ? 0 : std::clamp(-scale * factor_[c][at] * (psi[at] - psi[low]), -kFarthest, kFarthest);
    });
    fill_sides(c, shift_[c].data());
  }
}

void LiquidFlow::continue_outwards() {
  const mac::MacGrid& g = model_->grid;
  const auto layers = static_cast<int>(std::ceil(model_->def.cfl.value_or(1))) + 2;
  for (size_t c = 0; c < g.dimensions; ++c) {
    for_faces(c, [&](size_t at, size_t, int) { u_[c][at] = known_[c][at] ? u_[c][at] : 0; });
    mac::extrapolate(g, c, layers, u_[c].data(), known_[c].data(), work_.data(), fresh_.data(), *arena_);
    fill_velocity(c, u_[c].data());
  }
}

}  // namespace truestep::grid_fluid
