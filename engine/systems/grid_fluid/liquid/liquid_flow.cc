#include "engine/systems/grid_fluid/liquid/liquid_flow.h"

#include <algorithm>
#include <cmath>

#include "engine/kernels/mac/particles.h"

namespace truestep::grid_fluid {

using mac::kCentre;

namespace {
// Cells along the last axis that one task spreads to at a time; tasks of one colour never overlap.
constexpr size_t kSlab = 4;
constexpr size_t kParticles = 1024;  // per task, in passes where tasks share no values
}  // namespace

void LiquidFlow::bind(const FlowModel& m, std::span<const LiquidInlet> inlets, size_t most,
                      const ThreadArena& arena) {
  arena_ = &arena;
  if (model_ == &m) return;
  model_ = &m, most_ = most;
  const mac::MacGrid& g = m.grid;
  const size_t d = g.dimensions, n = g.size();
  affine_ = m.def.advection == GridFluidDef::Advection::apic;
  lifts_ = norm(m.gravity) > 0;
  width_ = 2 * d + (affine_ ? d * d : 0) + (lifts_ ? 1 : 0);
  now_.reserve(most * width_), sorted_.reserve(most * width_);
  row_.reserve(most), rows_sorted_.reserve(most);
  order_.reserve(most, g.cell_count());
  for (size_t c = 0; c < d; ++c) {
    for (Array* a : {&u_[c], &before_[c], &mass_[c], &factor_[c], &shift_[c]}) a->assign(n, 0);
    known_[c].assign(n, 0);
    const auto mirrors = m.mirrors(c);
    for (size_t a = 0; a < 3; ++a) {
      for (size_t end = 0; end < 2; ++end) {
        // Faces on sides keep their values, and inflow has no friction along its side.
        const bool even = mirrors[a][end] == mac::Mirror::given &&
                          (a == c || (a < d && m.kinds[a][end] == SideKind::inflow));
        sides_[c][a][end].mirror = even ? mac::Mirror::even : mirrors[a][end];
      }
    }
    force_[c].clear();
  }
  const auto mirrors = m.mirrors(kPressure);
  for (size_t a = 0; a < 3; ++a) {
    for (size_t end = 0; end < 2; ++end) cell_sides_[a][end].mirror = mirrors[a][end];
  }
  liquid_.assign(n, 0), fresh_.assign(n, 0), excess_.resize(g.cells[1] * g.cells[2]);
  for (Array* a : {&depth_, &work_}) a->assign(n, 0);
  if (lifts_) body_.assign(n, 0), runs_.assign(n, 0), bodies_.reserve(g.cell_count() / 2 + 2);
  solver_.emplace(g, mirrors);
  solids_.bind(m), given_.bind(m, inlets);
  if (m.def.viscosity > 0) viscosity_.bind(m, solids_);
  room_.bind(g, static_cast<size_t>(m.def.particles_per_axis), arena);
  room_.measure(*solids_, solids_.obstacles(), arena);
  for (size_t a = 0; a < d; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      if (m.kinds[a][end] == SideKind::outflow) room_.open(a, end, arena);
    }
  }
}

// Beside a wall that holds the liquid the parabola of kernels/mac/ghosts.h continues the velocity to the
// wall. Where the boundary layer is thinner than a cell there is no such profile: affine particles would find
// a slope of twice the velocity per half cell, carry it inwards, and spread it there as velocity. The
// boundary layer that grows along a cell of wall is 5 / sqrt(|u| dx / viscosity) cells thick (Blasius 1908);
// where that is less than one, the parabola counts by its square.
void LiquidFlow::fill_velocity(size_t c, double* u) {
  fill_sides(c, u);
  const mac::MacGrid& g = model_->grid;
  for (size_t a = 0; a < g.dimensions; ++a) {
    if (a == c) continue;
    const auto s = static_cast<ptrdiff_t>(g.stride(a));
    const double resolved = 25 * model_->def.viscosity / g.spacing[a];
    for (size_t end = 0; end < 2; ++end) {
      if (sides_[c][a][end].mirror != mac::Mirror::given) continue;
      const size_t first = mac::kGhosts + (end == 0 ? 0 : g.cells[a] - 1);
      const ptrdiff_t inwards = end == 0 ? s : -s;
      mac::for_lines(g, a, *arena_, [=](size_t line) {
        double* cell = u + line + first * static_cast<size_t>(s);
        const double speed = std::abs(cell[0]), share = speed > resolved ? resolved / speed : 1;
        const double parabola = (cell[inwards] - 6 * cell[0]) / 3;
        cell[-inwards] = share == 1 ? parabola : cell[0] + share * (parabola - cell[0]);
      });
    }
  }
}

void LiquidFlow::place_obstacles(double t) {
  if (solids_.place(t)) room_.measure(*solids_, solids_.obstacles(), *arena_);
}

void LiquidFlow::load(const LiquidFields& f) {
  const mac::MacGrid& g = model_->grid;
  const size_t d = g.dimensions;
  rows_ = f.rows;
  for (Array* a : {&now_, &sorted_}) a->resize(rows_ * width_);
  row_.resize(rows_), rows_sorted_.resize(rows_);
  arena_->for_blocks(rows_, kParticles, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      double* to = particle(now_, p);
      for (size_t a = 0; a < d; ++a) {
        const auto n = static_cast<double>(g.cells[a]);
        to[a] = std::clamp((f.position[3 * p + a] - g.origin[a]) / g.spacing[a], 0.0, n);
        to[d + a] = f.velocity[3 * p + a];
      }
      if (affine_) std::copy_n(f.affine + d * d * p, d * d, to + 2 * d);
      if (lifts_) to[width_ - 1] = f.owed[p];
      row_[p] = static_cast<uint32_t>(p);
    }
  });
}

void LiquidFlow::store(LiquidFields& f) {
  const mac::MacGrid& g = model_->grid;
  const size_t d = g.dimensions;
  arena_->for_blocks(rows_, kParticles, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      const double* from = particle(now_, p);
      const size_t row = row_[p];
      for (size_t a = 0; a < d; ++a) {
        f.position[3 * row + a] = g.origin[a] + g.spacing[a] * from[a];
        f.velocity[3 * row + a] = from[d + a];
      }
      if (affine_) std::copy_n(from + 2 * d, d * d, f.affine + d * d * row);
      if (lifts_) f.owed[row] = from[width_ - 1];
    }
  });
}

double LiquidFlow::crossing_rate(double t) {
  place_obstacles(t);
  const mac::MacGrid& g = model_->grid;
  const size_t d = g.dimensions;
  const double most = largest_block(*arena_, rows_, kParticles, [&](size_t begin, size_t end) {
    double fastest = 0;
    for (size_t p = begin; p < end; ++p) {
      const double* v = now_.data() + width_ * p + d;
      double sum = 0;
      for (size_t a = 0; a < d; ++a) sum += std::abs(v[a]) / g.spacing[a];
      // One value that is not finite decides.
      if (!(sum <= fastest)) fastest = sum;
      if (!std::isfinite(sum)) break;
    }
    return fastest;
  });
  given_.place(t, rows_ < most_ ? GivenFlow::Room::left : GivenFlow::Room::none);
  const double other = std::max(solids_.crossing_rate(), given_.crossing_rate());
  return other > most ? other : most;
}

// Sorts particles by cell, keeping their order within a cell.
template <size_t D>
void LiquidFlow::sort() {
  const mac::MacGrid& g = model_->grid;
  order_.sort(
      rows_, g.cell_count(),
      [&](size_t p) {
        const double* x = particle(now_, p);
        size_t cell = 0;
        for (size_t a = D; a-- > 0;) {
          cell = cell * g.cells[a] + std::min(static_cast<size_t>(x[a]), g.cells[a] - 1);
        }
        return cell;
      },
      *arena_);
  arena_->for_blocks(rows_, kParticles, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const size_t p = order_.point(k);
      std::copy_n(particle(now_, p), width_, particle(sorted_, k));
      rows_sorted_[k] = row_[p];
    }
  });
  now_.swap(sorted_), row_.swap(rows_sorted_);
}

template <size_t D>
void LiquidFlow::spread(LiquidFields& f) {
  const mac::MacGrid& g = model_->grid;
  for (size_t c = 0; c < D; ++c) {
    mac::fill_all(g, 0.0, mass_[c].data(), *arena_);
    mac::fill_all(g, 0.0, u_[c].data(), *arena_);
  }
  mac::fill_all(g, 0.0, f.fill, *arena_);
  const size_t last = g.cells[D - 1], layer = g.cell_count() / last;
  const size_t slabs = (last + kSlab - 1) / kSlab;
  for (size_t colour = 0; colour < 2; ++colour) {
    arena_->for_blocks((slabs + 1 - colour) / 2, 1, [&](size_t begin, size_t end) {
      for (size_t s = begin; s < end; ++s) {
        const size_t low = (2 * s + colour) * kSlab, high = std::min(low + kSlab, last);
        for (size_t p = order_.start(low * layer); p < order_.start(high * layer); ++p) {
          const double* x = particle(now_, p);
          for (size_t c = 0; c < D; ++c) {
            mac::scatter<D>(g, mac::around_particle<D>(g, c, x), x[D + c],
                            affine_ ? x + 2 * D + D * c : nullptr, mass_[c].data(), u_[c].data());
          }
          mac::scatter<D>(g, mac::around_particle<D>(g, kCentre, x), f.fill);
        }
      }
    });
  }
  for (size_t c = 0; c < D; ++c) {
    mac::fold_periodic(g, mass_[c].data(), *arena_), mac::fold_periodic(g, u_[c].data(), *arena_);
  }
  mac::fold_cells(g, f.fill, *arena_);
}

void LiquidFlow::clear_of_obstacles(double* x, double* v) const {
  const mac::MacGrid& g = model_->grid;
  const size_t d = g.dimensions;
  uint32_t which = 0;
  Vec3 place;
  const auto distance = [&](const double* cells) {
    double p[3] = {};
    for (size_t a = 0; a < d; ++a) p[a] = g.origin[a] + g.spacing[a] * cells[a];
    place = {p[0], p[1], p[2]};
    return distance_to(solids_.obstacles(), place, d, &which);
  };
  const double deep = distance(x);
  if (deep >= 0) return;
  double normal[3] = {}, length = 0;
  constexpr double kStep = 1e-3;  // cells
  for (size_t a = 0; a < d; ++a) {
    double low[3] = {x[0], x[1], d == 3 ? x[2] : 0}, high[3] = {x[0], x[1], d == 3 ? x[2] : 0};
    low[a] -= kStep, high[a] += kStep;
    normal[a] = distance(high) - distance(low), length += normal[a] * normal[a];
  }
  if (length == 0) return;
  length = std::sqrt(length);
  distance(x);
  const Vec3 wall = solids_.velocity(which, place);
  const double own[] = {wall.x, wall.y, wall.z};
  double into = 0;
  for (size_t a = 0; a < d; ++a) normal[a] /= length, into += (v[a] - own[a]) * normal[a];
  for (size_t a = 0; a < d; ++a) {
    x[a] -= deep / g.spacing[a] * normal[a];
    if (into < 0) v[a] -= into * normal[a];
  }
}

template <size_t D>
void LiquidFlow::hold(double* q, Beyond beyond) const {
  const mac::MacGrid& g = model_->grid;
  for (size_t a = 0; a < D; ++a) {
    const auto n = static_cast<double>(g.cells[a]);
    if (g.periodic[a]) {
      q[a] -= n * std::floor(q[a] / n);
      if (!(q[a] < n)) q[a] = 0;
    } else if (q[a] < 0 || q[a] > n) {
      if (beyond == Beyond::stay || !lets_out(a, q[a] < 0 ? 0 : 1, q)) q[a] = std::clamp(q[a], 0.0, n);
    }
  }
}

// Through an outflow everywhere, through an inflow where its given velocity points outwards.
bool LiquidFlow::lets_out(size_t a, size_t end, const double* x) const {
  if (model_->kinds[a][end] != SideKind::inflow) return model_->kinds[a][end] == SideKind::outflow;
  const mac::MacGrid& g = model_->grid;
  size_t at = g.base() + (end == 0 ? 0 : g.cells[a]) * g.stride(a);
  for (size_t b = 0; b < g.dimensions; ++b) {
    if (b == a) continue;
    at += g.stride(b) * static_cast<size_t>(std::clamp(x[b], 0.0, static_cast<double>(g.cells[b] - 1)));
  }
  return end == 0 ? u_[a][at] < 0 : u_[a][at] > 0;
}

// Particles in a nozzle move with it.
template <size_t D>
bool LiquidFlow::in_nozzle(double* x, double h) const {
  const mac::MacGrid& g = model_->grid;
  double place[3] = {};
  for (size_t a = 0; a < D; ++a) place[a] = g.origin[a] + g.spacing[a] * x[a];
  const LiquidInlet* inlet = given_.holder({place[0], place[1], place[2]});
  if (!inlet) return false;
  const Vec3 u = inlet->velocity();
  const double own[] = {u.x, u.y, u.z};
  for (size_t a = 0; a < D; ++a) x[a] += h * own[a] / g.spacing[a], x[D + a] = own[a];
  if (affine_) std::fill_n(x + 2 * D, D * D, 0.0);
  return true;
}

template <size_t D>
double LiquidFlow::carry(double h) {
  const mac::MacGrid& g = model_->grid;
  const double keep = model_->def.flip,
               weight[] = {-model_->gravity.x * g.spacing[0], -model_->gravity.y * g.spacing[1],
                           -model_->gravity.z * g.spacing[2]};
  const auto block = [&](size_t begin, size_t end) {
    double lift = 0;
    for (size_t p = begin; p < end; ++p) {
      double *x = particle(now_, p), *v = x + D;
      if (given_.any() && in_nozzle<D>(x, h)) continue;
      double middle[D], shift[D], lifted = 0;
      for (size_t c = 0; c < D; ++c) {
        const auto around = mac::around_particle<D>(g, c, x);
        const double u = mac::gather<D>(g, around, u_[c].data());
        if (affine_) {
          v[c] = u;
          mac::gather_slopes<D>(g, around, u_[c].data(), x + 2 * D + D * c);
        } else {
          v[c] = u + keep * (v[c] - mac::gather<D>(g, around, before_[c].data()));
        }
        shift[c] = mac::gather<D>(g, around, shift_[c].data());
        lifted += weight[c] * shift[c];
        middle[c] = x[c] + 0.5 * h * u / g.spacing[c];
      }
      if (lifts_) x[width_ - 1] += lifted, lift += lifted;
      hold<D>(middle, Beyond::stay);
      for (size_t c = 0; c < D; ++c) {
        const double u = mac::gather<D>(g, mac::around_particle<D>(g, c, middle), u_[c].data());
        x[c] += h * u / g.spacing[c] + shift[c];
      }
      if (model_->solids.any()) clear_of_obstacles(x, v);
      hold<D>(x, Beyond::leave);
    }
    return lift;
  };
  return arena_->sum_blocks(rows_, kParticles, block);
}

LiquidReport LiquidFlow::substep(LiquidFields& f, double t, double h) {
  const bool plane = model_->grid.dimensions == 2;
  LiquidReport report;
  place_obstacles(t);
  given_.place(t, rows_ < most_ ? GivenFlow::Room::left : GivenFlow::Room::none);
  plane ? sort<2>() : sort<3>();
  plane ? spread<2>(f) : spread<3>(f);
  settle_faces(t, h);
  find_surface(f);
  if (lifts_) number_bodies();
  if (model_->def.viscosity > 0) apply_viscosity(h, report);
  project(f, h, report);
  take_back_compression(f, report);
  continue_outwards();
  // Keeps particles out of where obstacles will be.
  place_obstacles(t + h);
  *f.lifted += plane ? carry<2>(h) : carry<3>(h);
  if (lifts_) pay_for_lift(h);
  return report;
}

}  // namespace truestep::grid_fluid
