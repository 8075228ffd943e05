// What a flow on a grid gives out, from cells and faces, and its drawing.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/kernels/mac/share.h"
#include "engine/systems/grid_fluid/fluid_rows.h"
#include "engine/systems/grid_fluid/grid_fluid.h"
#include "engine/systems/grid_fluid/liquid/liquid.h"

namespace truestep::grid_fluid {

namespace {

template <class F>
void for_cells(const mac::MacGrid& g, F&& f) {
  size_t row = 0;
  for (size_t k = 0; k < g.cells[2]; ++k) {
    for (size_t j = 0; j < g.cells[1]; ++j) {
      const size_t at = g.at(0, j, k);
      for (size_t i = 0; i < g.cells[0]; ++i) f(row++, at + i, i, j, k);
    }
  }
}

// Offset from a cell to its upper face: the last one of a periodic axis is the first.
ptrdiff_t after(const mac::MacGrid& g, size_t axis, size_t cell) {
  const auto s = static_cast<ptrdiff_t>(g.stride(axis));
  return g.periodic[axis] && cell + 1 == g.cells[axis] ? -s * static_cast<ptrdiff_t>(cell) : s;
}

}  // namespace

double GridFluid::rms_error(const State& s, double t) const {
  const mac::MacGrid& g = model_.grid;
  std::vector<double> exact(g.size());
  double sum = 0;
  for (size_t c = 0; c < g.dimensions; ++c) {
    model_.texts.sample(model_.texts.exact[c], g, c, t, exact.data());
    const auto u = s.f64(static_cast<State::Column>(c));
    double squares = 0, count = 0;
    for (size_t k = 0; k < g.count(c, 2); ++k) {
      for (size_t j = 0; j < g.count(c, 1); ++j) {
        for (size_t i = 0; i < g.count(c, 0); ++i) {
          const double e = u[g.at(i, j, k)] - exact[g.at(i, j, k)];
          squares += e * e, count += 1;
        }
      }
    }
    sum += squares / count;
  }
  return std::sqrt(sum);
}

// Averaged over the cell's corners or edges: second order inside; at sides from the cell's own values.
void GridFluid::vorticity(const State& s, ShownRows, double* out) const {
  const mac::MacGrid& g = model_.grid;
  const double* u[3] = {};
  for (size_t c = 0; c < g.dimensions; ++c) u[c] = s.f64(static_cast<State::Column>(c)).data();
  for_cells(g, [&](size_t row, size_t at, size_t i, size_t j, size_t k) {
    const size_t place[] = {i, j, k};
    const auto slope = [&](size_t c, size_t a) {
      const size_t sa = g.stride(a);
      const ptrdiff_t sc = after(g, c, place[c]);
      const bool low = place[a] > 0 || g.periodic[a], high = place[a] + 1 < g.cells[a] || g.periodic[a];
      const double* here = u[c] + at;
      const size_t wrap = g.cells[a] * sa;
      const double* behind = !low ? here : place[a] > 0 ? here - sa : here - sa + wrap;
      const double* ahead = !high ? here : place[a] + 1 < g.cells[a] ? here + sa : here + sa - wrap;
      const double width = (low && high ? 2 : 1) * g.spacing[a];
      return 0.5 * (ahead[0] + ahead[sc] - behind[0] - behind[sc]) / width;
    };
    if (g.dimensions == 2) {
      out[row] = slope(1, 0) - slope(0, 1);
      return;
    }
    const double x = slope(2, 1) - slope(1, 2), y = slope(0, 2) - slope(2, 0), z = slope(1, 0) - slope(0, 1);
    out[row] = std::sqrt(x * x + y * y + z * z);
  });
}

Vec3 GridFluid::velocity_in(const State& s, size_t at, const size_t* place) const {
  double v[3] = {};
  for (size_t c = 0; c < model_.grid.dimensions; ++c) {
    const double* u = s.f64(static_cast<State::Column>(c)).data() + at;
    v[c] = 0.5 * (u[0] + u[after(model_.grid, c, place[c])]);
  }
  return {v[0], v[1], v[2]};
}

void GridFluid::velocity(const State& s, ShownRows, double* out) const {
  for_cells(model_.grid, [&](size_t row, size_t at, size_t i, size_t j, size_t k) {
    const size_t place[] = {i, j, k};
    store3(out, row, velocity_in(s, at, place));
  });
}

void GridFluid::speed(const State& s, ShownRows, double* out) const {
  for_cells(model_.grid, [&](size_t row, size_t at, size_t i, size_t j, size_t k) {
    const size_t place[] = {i, j, k};
    out[row] = norm(velocity_in(s, at, place));
  });
}

void GridFluid::pressure(const State& s, ShownRows, double* out) const {
  const mac::MacGrid& g = model_.grid;
  const auto q = s.f64(pressure_column());
  for_cells(g, [&](size_t row, size_t at, size_t i, size_t j, size_t k) {
    out[row] = model_.def.density * q[at];
    if (!second_) return;
    // The state's pressure excludes density gravity . x.
    const size_t place[] = {i, j, k};
    for (size_t a = 0; a < g.dimensions; ++a) {
      out[row] += model_.density_of(s.f64(*second_)[at]) * model_.held_gravity(a) *
                  g.coordinate(mac::kCentre, a, static_cast<double>(place[a]));
    }
  });
}

void GridFluid::copy_cells(const State& s, State::Column column, double* out) const {
  const auto q = s.f64(column);
  for_cells(model_.grid, [&](size_t row, size_t at, size_t, size_t, size_t) { out[row] = q[at]; });
}

double GridFluid::mass(const State& s, double t) const {
  const mac::MacGrid& g = model_.grid;
  if (!second_) {
    ObstaclePlaces now;
    if (model_.texts.obstacles_move) model_.texts.place_obstacles(model_.def.obstacles, t, now);
    return model_.def.density * (model_.texts.obstacles_move ? fluid_volume(now.obstacles, g) : room_);
  }
  const double* share = s.f64(*second_).data();
  double second = 0;
  for_cells(g, [&](size_t, size_t at, size_t, size_t, size_t) { second += share[at]; });
  const double all = static_cast<double>(g.cell_count());
  return g.cell_volume() * (model_.def.density * (all - second) + model_.def.second_fluid->density * second);
}

// Within a cell that both fluids share, each is on its side of the border: waves lower than a cell have all
// of their energy there.
double GridFluid::gravity_of_two(const State& s) const {
  const mac::MacGrid& g = model_.grid;
  const auto shares = s.f64(*second_);
  std::vector<double> share(shares.begin(), shares.end());
  static const ThreadArena kSerial(1);
  mac::Sides sides;
  const auto mirrors = model_.mirrors(mac::kCentre);
  for (size_t a = 0; a < 3; ++a) {
    for (size_t end = 0; end < 2; ++end) sides[a][end].mirror = mirrors[a][end];
  }
  mac::fill_ghosts(g, mac::kCentre, sides, share.data(), kSerial);
  const double weight[] = {model_.gravity.x, model_.gravity.y, model_.gravity.z};
  const double jump = model_.density_of(1) - model_.density_of(0);
  double potential = 0;
  for_cells(g, [&](size_t, size_t at, size_t i, size_t j, size_t k) {
    const size_t place[] = {i, j, k};
    const double here = share[at];
    const mac::Border border = here > 0 && here < 1 ? mac::border_in(g, share.data(), at) : mac::Border{};
    const bool cut = border.normal != std::array<double, 3>{};
    for (size_t a = 0; a < g.dimensions; ++a) {
      if (weight[a] == 0) continue;
      const double centre = g.coordinate(mac::kCentre, a, static_cast<double>(place[a]));
      const double aside = cut ? (mac::share_moment(border, a) - 0.5 * here) * g.spacing[a] : 0;
      potential -= weight[a] * (model_.density_of(here) * centre + jump * aside);
    }
  });
  return g.cell_volume() * potential;
}

FluidNumbers GridFluid::measure(const State& s, double t) const {
  const mac::MacGrid& g = model_.grid;
  const double* second = second_ ? s.f64(*second_).data() : nullptr;
  double energy = 0, enstrophy = 0, divergence = 0, fastest = 0;
  std::vector<double> curl(g.cell_count());
  vorticity(s, {}, curl.data());
  for_cells(g, [&](size_t row, size_t at, size_t i, size_t j, size_t k) {
    const size_t place[] = {i, j, k};
    double div = 0, squares = 0;
    for (size_t c = 0; c < g.dimensions; ++c) {
      const double* u = s.f64(static_cast<State::Column>(c)).data() + at;
      const double low = u[0], high = u[after(g, c, place[c])];
      squares += low * low + high * high;
      fastest = std::max({fastest, std::abs(low), std::abs(high)});
      const double* open = model_.solids.any() ? model_.solids.open[c].data() + at : nullptr;
      div += (open ? open[g.stride(c)] * high - open[0] * low : high - low) / g.spacing[c];
    }
    energy += 0.25 * model_.density_of(second ? second[at] : 0) * squares;
    divergence = std::max(divergence, std::abs(div));
    enstrophy += 0.5 * curl[row] * curl[row];
  });
  const double volume = g.cell_volume();
  const auto numbers = s.f64(numbers_);
  FluidNumbers out{.kinetic = volume * energy,
                   .fastest = fastest,
                   .cfl = numbers[kCfl],
                   .substeps = numbers[kSubsteps],
                   .mass = mass(s, t),
                   .enstrophy = volume * enstrophy};
  // With moving obstacles, or differences beyond the sides: as recorded at the end of the step.
  out.divergence = model_.keeps_divergence() ? numbers[kDivergence] : divergence;
  if (stream_) {
    const auto found = s.f64(*stream_ + 1);
    out.steady_iterations = found[kSteadyIterations], out.steady_change = found[kChange];
  }
  if (model_.solids.any() || second)
    out.pressure_iterations = numbers[kIterations], out.pressure_residual = numbers[kResidual];
  if (model_.solids.any()) {
    out.drag = numbers[kDrag], out.lift = numbers[kLift];
    if (model_.texts.obstacles_turn) out.torque = numbers[kTorque];
  }
  const auto integral = [&](State::Column c) {
    const auto q = s.f64(c);
    double total = 0;
    for_cells(g, [&](size_t, size_t at, size_t, size_t, size_t) { total += q[at]; });
    return volume * total;
  };
  if (second) out.second_volume = integral(*second_), out.gravity = gravity_of_two(s);
  if (scalar_) out.scalar = integral(*scalar_);
  if (model_.texts.has_exact) out.error = rms_error(s, t);
  return out;
}

void GridFluid::draw(const State&, double t, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::constant)) {
    out.parts.resize(parts().size());
    if (model_.grid.dimensions == 2) out.parts[0].space = PartDrawing::Space::plane;
  }
  if (!wants(wishes, Wish::obstacles)) return;
  ObstaclePlaces now;
  model_.texts.place_obstacles(model_.def.obstacles, t, now);
  draw_obstacles(now.obstacles, out);
}

void draw_obstacles(const std::vector<ObstacleDef>& obstacles, Drawing& out) {
  for (const ObstacleDef& o : obstacles) {
    DrawnShape shape;
    const bool sphere = o.shape == ObstacleDef::Shape::sphere;
    shape.kind = sphere ? DrawnShape::Kind::sphere : DrawnShape::Kind::box;
    shape.position = o.center;
    shape.orientation = {o.turned.w, o.turned.x, o.turned.y, o.turned.z};
    shape.size = sphere ? Vec3{o.radius, 0, 0} : o.half;
    out.obstacles.push_back(shape);
  }
}

}  // namespace truestep::grid_fluid
