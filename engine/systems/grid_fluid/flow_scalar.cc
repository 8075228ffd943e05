// The scalar that a flow carries. It goes through whole faces with the flow that the pressure solver has made
// free of divergence, so that it neither grows nor shrinks and stays between its extremes. Cells cut by an
// obstacle count as whole; a moving obstacle takes along what is inside it.
#include <algorithm>
#include <cmath>

#include "engine/kernels/mac/carry.h"
#include "engine/kernels/mac/fourth_order.h"
#include "engine/systems/grid_fluid/flow.h"

namespace truestep::grid_fluid {

using mac::kCentre;

mac::ConstFields Flow::scalar_flow(FlowFields& f, double t) {
  const mac::MacGrid& g = model_->grid;
  fill(f, t);
  balance(f);
  if (model_->solids.any()) {
    place_obstacles(t);
    return flow_between_solids(f);
  }
  if (!model_->fourth_order()) return {f.u[0], f.u[1], f.u[2]};
  mac::ConstFields out{};
  for (size_t c = 0; c < g.dimensions; ++c) {
    double* passing = array(6 + c);
    mac::flow_through4(g, c, f.u[c], passing, *arena_);
    fill_component(c, passing);
    out[c] = passing;
  }
  return out;
}

void Flow::carry(FlowFields& f, double t, double h, Axes order) {
  const mac::MacGrid& g = model_->grid;
  const ScalarDef& d = *model_->def.scalar;
  const mac::ConstFields u = scalar_flow(f, t);
  double *content = array(0), *room = array(1), *flux = array(2), *q = f.scalar;
  const int n = std::max(1, static_cast<int>(std::ceil(h * mac::largest_outflow(g, u, *arena_) - 1e-9)));
  const double part = h / n;
  for (int pass = 0; pass < n; ++pass) {
    const bool forwards = (order == Axes::forwards) == (pass % 2 == 0);
    mac::fill_all(g, 1.0, room, *arena_);
    mac::copy_all(g, q, content, *arena_);
    for (size_t k = 0; k < g.dimensions; ++k) {
      const size_t a = forwards ? k : g.dimensions - 1 - k;
      mac::fill_ghosts(g, kCentre, scalar_sides_, q, *arena_);
      if (k > 0) mac::fill_ghosts(g, kCentre, scalar_sides_, room, *arena_);
      mac::scalar_flux(g, a, u[a], part, q, room, flux, *arena_);
      mac::pass_scalar(g, a, u[a], part, flux, content, room, q, *arena_);
    }
    // The room is 1 again, up to the divergence that the pressure solver has left.
    mac::for_rows(g, kCentre, *arena_,
                  [&](size_t at, size_t, size_t, size_t row) { std::copy_n(content + at, row, q + at); });
  }
  if (!model_->texts.scalar_source.zero) {
    const Program& program = model_->texts.scalar_source;
    if (source_.empty() || program.time) {
      source_.resize(g.size());
      model_->texts.sample(program, g, kCentre, t, source_.data(), *arena_);
    }
    mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t, size_t, size_t row) {
      for (size_t i = at; i < at + row; ++i) q[i] += h * source_[i];
    });
  }
  if (d.diffusivity > 0) scalar_->solve(1, h * d.diffusivity, q, *arena_);
}

}  // namespace truestep::grid_fluid
