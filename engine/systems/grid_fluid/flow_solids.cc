// Effects of obstacles on a flow: their positions, the velocities of the fluid in and next to them, and the
// impulses they receive.
#include <algorithm>
#include <cmath>

#include "engine/kernels/mac/fourth_order.h"
#include "engine/kernels/mac/particles.h"
#include "engine/systems/grid_fluid/flow.h"

namespace truestep::grid_fluid {

using mac::kCentre;

bool FlowModel::sharp_walls() const {
  return solids.any() && def.advection == GridFluidDef::Advection::central &&
         def.viscous != GridFluidDef::Viscous::implicit;
}

void Flow::place_obstacles(double t) {
  if (!solids_.place(t)) return;
  cut_pressure_->set({solids_->open[0].data(), solids_->open[1].data(), solids_->open[2].data()}, nullptr,
                     *arena_);
}

void Flow::move_obstacles(FlowFields& f, double t) {
  if (!model_->texts.obstacles_move) return;
  const mac::MacGrid& g = model_->grid;
  for (size_t c = 0; c < g.dimensions; ++c) were_inside_[c] = solids_->inside[c];
  place_obstacles(t);
  // Faces that an obstacle uncovers keep the velocity that was extended into it, but not the rate they had
  // inside.
  for (size_t c = 0; c < g.dimensions && model_->sharp_walls(); ++c) {
    double* rate = f.rate[c] ? f.rate[c] : array(3 + c);
    for (const Solids::Face& face : were_inside_[c]) {
      if (!solids_->is_inside(c, face.at)) rate[face.at] = 0;
    }
  }
}

void Flow::note_turning(FlowFields& f, const Solids::Face& face, size_t c, double amount) const {
  if (!model_->texts.obstacles_turn) return;
  f.turning += amount * solids_.lever(face, c) * model_->grid.cell_volume();
}

void Flow::stop_in_solids(FlowFields& f) {
  for (size_t c = 0; c < model_->grid.dimensions; ++c) {
    const double* fluid = solids_->fluid[c].data();
    double taken = 0;
    for (const Solids::Face& face : solids_->shut[c]) {
      double& u = f.u[c][face.at];
      const double share = 1 - fluid[face.at], had = share * u;
      taken += had;
      u *= fluid[face.at];
      if (!model_->texts.obstacles_move) continue;
      const double given = share * solids_.velocity(face, c);
      u += given, taken -= given;
      note_turning(f, face, c, had - given);
    }
    f.impulse[c] += taken * model_->grid.cell_volume();
  }
}

namespace {
template <size_t D>
double at_image(const mac::MacGrid& g, const Solids::Wall& w, size_t image, const double* u) {
  mac::Around<D> around;
  around.at = w.image[image];
  for (size_t a = 0; a < D; ++a) around.share[a] = w.share[image][a];
  return mac::gather<D>(g, around, u);
}
}  // namespace

void Flow::extend_into_solids(FlowFields& f, At where) {
  const mac::MacGrid& g = model_->grid;
  for (size_t c = 0; c < g.dimensions; ++c) {
    double* u = f.u[c];
    for (const Solids::Face& face : solids_->inside[c]) u[face.at] = solids_.velocity(face, c);
    for (const Solids::Wall& w : solids_->walls[c]) {
      if (where == At::open_part && solids_->open[c][w.face.at] == 0) continue;
      const auto& weight = where == At::centre ? w.ghost : w.flux;
      const Vec3 wall = solids_.velocity(w.face.obstacle, w.foot);
      const double own = c == 0 ? wall.x : c == 1 ? wall.y : wall.z;
      double value = own;
      for (size_t m = 0; m < 2; ++m) {
        if (weight[m] == 0) continue;
        const double there = g.dimensions == 2 ? at_image<2>(g, w, m, u) : at_image<3>(g, w, m, u);
        value += weight[m] * (there - own);
      }
      u[w.face.at] = value;
    }
    fill_component(c, u);
  }
}

void Flow::hold_solids(FlowFields& f, size_t c, double* change) {
  double taken = 0;
  for (const Solids::Face& face : solids_->inside[c]) {
    taken += change[face.at];
    note_turning(f, face, c, change[face.at]);
    change[face.at] = 0;
  }
  f.impulse[c] += taken * model_->grid.cell_volume();
}

mac::ConstFields Flow::flow_between_solids(const FlowFields& f) {
  const mac::MacGrid& g = model_->grid;
  double* passing[3] = {array(6), array(7), array(8)};
  for (size_t c = 0; c < g.dimensions; ++c) {
    const double *open = solids_->open[c].data(), *u = f.u[c];
    arena_->for_blocks(g.size(), kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) passing[c][i] = open[i] * u[i];
    });
    if (!model_->texts.obstacles_move) continue;
    for (const Solids::Face& face : solids_->shut[c])
      passing[c][face.at] += (1 - open[face.at]) * solids_.velocity(face, c);
  }
  return {passing[0], passing[1], passing[2]};
}

void Flow::divergence_between_solids(const FlowFields& f, double* phi) {
  mac::divergence(model_->grid, flow_between_solids(f), phi, *arena_);
}

void Flow::settle_shut_faces(FlowFields& f, size_t c, const double* phi) {
  const mac::MacGrid& g = model_->grid;
  const double* open = solids_->open[c].data();
  double taken = 0;
  if (model_->sharp_walls()) {
    const double scale = 1 / g.spacing[c];
    for (const Solids::Face& face : solids_->inside[c]) {
      const double given = -scale * (phi[face.at] - phi[face.at - g.stride(c)]);
      taken += given;
      note_turning(f, face, c, given);
      if (open[face.at] == 0) f.u[c][face.at] = solids_.velocity(face, c);
    }
  } else {
    for (const Solids::Face& face : solids_->shut[c]) {
      if (open[face.at] > 0) continue;
      const double own = solids_.velocity(face, c);
      note_turning(f, face, c, f.u[c][face.at] - own);
      taken += f.u[c][face.at] - own, f.u[c][face.at] = own;
    }
  }
  f.impulse[c] += taken * g.cell_volume();
}

void Flow::extend_pressure(FlowFields& f) {
  const mac::MacGrid& g = model_->grid;
  const auto shut = [&](size_t at) {
    for (size_t c = 0; c < g.dimensions; ++c) {
      if (solids_->open[c][at] > 0 || solids_->open[c][at + g.stride(c)] > 0) return false;
    }
    return true;
  };
  // Written last, so that no extended value is read.
  double* found = array(9);
  mac::for_rows(g, kCentre, *arena_, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) {
      found[i] = f.pressure[i];
      if (!shut(i)) continue;
      double sum = 0, count = 0;
      for (size_t a = 0; a < g.dimensions; ++a) {
        for (const size_t m : {i - g.stride(a), i + g.stride(a)}) {
          if (!shut(m)) sum += f.pressure[m], count += 1;
        }
      }
      found[i] = count > 0 ? sum / count : 0;
    }
  });
  mac::for_rows(g, kCentre, *arena_,
                [&](size_t at, size_t, size_t, size_t n) { std::copy_n(found + at, n, f.pressure + at); });
}

double Flow::largest_divergence(FlowFields& f, double t) {
  fill(f, t);
  place_obstacles(t);
  double* phi = array(9);
  if (model_->fourth_order()) {
    mac::divergence4(model_->grid, {f.u[0], f.u[1], f.u[2]}, phi, *arena_);
  } else {
    divergence_between_solids(f, phi);
  }
  const mac::MacGrid& g = model_->grid;
  return mac::largest_of_rows(g, kCentre, *arena_, [phi](size_t at, size_t n) {
    double most = 0;
    for (size_t i = at; i < at + n; ++i) most = std::max(most, std::abs(phi[i]));
    return most;
  });
}

}  // namespace truestep::grid_fluid
