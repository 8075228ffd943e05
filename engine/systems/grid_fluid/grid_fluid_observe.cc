// Observables, fields and drawing of a flow on a grid.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/kernels/mac/share.h"
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
void GridFluid::vorticity(const State& s, double* out) const {
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

FieldView GridFluid::field(const State& s, size_t, size_t field, std::vector<double>& scratch) const {
  const mac::MacGrid& g = model_.grid;
  const size_t n = g.cell_count();
  const bool vector = field == 0;
  scratch.assign(vector ? 3 * n : n, 0);
  if (field <= 1) {
    for_cells(g, [&](size_t row, size_t at, size_t i, size_t j, size_t k) {
      const size_t place[] = {i, j, k};
      double v[3] = {};
      for (size_t c = 0; c < g.dimensions; ++c) {
        const double* u = s.f64(static_cast<State::Column>(c)).data() + at;
        v[c] = 0.5 * (u[0] + u[after(g, c, place[c])]);
      }
      if (vector) {
        std::copy_n(v, 3, &scratch[3 * row]);
      } else {
        scratch[row] = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
      }
    });
  } else if (field == 3) {
    vorticity(s, scratch.data());
  } else {
    const double scale = field == 2 ? model_.def.density : 1;
    const auto q = s.f64(field == 2 ? pressure_column() : field == 4 && scalar_ ? *scalar_ : *second_);
    for_cells(g, [&](size_t row, size_t at, size_t i, size_t j, size_t k) {
      scratch[row] = scale * q[at];
      if (field != 2 || !second_) return;
      // The state's pressure excludes density gravity . x.
      const size_t place[] = {i, j, k};
      for (size_t a = 0; a < g.dimensions; ++a) {
        scratch[row] += model_.density_of(s.f64(*second_)[at]) * model_.held_gravity(a) *
                        g.coordinate(mac::kCentre, a, static_cast<double>(place[a]));
      }
    });
  }
  return {scratch.data(), Scalar::f64, n, vector ? 3u : 1u};
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

void GridFluid::observe(const State& s, double t, Observables& out) const {
  const mac::MacGrid& g = model_.grid;
  const double* second = second_ ? s.f64(*second_).data() : nullptr;
  double energy = 0, enstrophy = 0, divergence = 0, fastest = 0;
  std::vector<double> curl(g.cell_count());
  vorticity(s, curl.data());
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
  out.add("energy.kinetic", volume * energy, "J");
  out.add("mass", mass(s, t), "kg");
  out.add("enstrophy", volume * enstrophy, "1/s^2");
  // With moving obstacles, or differences beyond the sides: as recorded at the end of the step.
  out.add("divergence.max", model_.keeps_divergence() ? s.f64(numbers_)[8] : divergence, "1/s");
  out.add("speed.max", fastest, "m/s");
  out.add("cfl", s.f64(numbers_)[3], "1");
  out.add("substeps", s.f64(numbers_)[2], "1");
  if (stream_) {
    const auto found = s.f64(*stream_ + 1);
    out.add("steady.iterations", found[kSteadyIterations], "1");
    out.add("steady.change", found[kChange], "1");
  }
  if (model_.solids.any()) {
    const auto numbers = s.f64(numbers_);
    out.add("pressure.iterations", numbers[4], "1");
    out.add("pressure.residual", numbers[5], "1");
    out.add("obstacle.drag", numbers[6], "N");
    out.add("obstacle.lift", numbers[7], "N");
    if (model_.texts.obstacles_turn) out.add("obstacle.torque", numbers[9], "N m");
  }
  if (second) {
    double filled = 0;
    for_cells(g, [&](size_t, size_t at, size_t, size_t, size_t) { filled += second[at]; });
    out.add("second_fluid.volume", volume * filled, "m^3");
    out.add("energy.gravity", gravity_of_two(s), "J");
    out.add("pressure.iterations", s.f64(numbers_)[4], "1");
    out.add("pressure.residual", s.f64(numbers_)[5], "1");
  }
  if (scalar_) {
    const auto q = s.f64(*scalar_);
    double total = 0;
    for_cells(g, [&](size_t, size_t at, size_t, size_t, size_t) { total += q[at]; });
    out.add("scalar.total", volume * total, "1");
  }
  if (model_.texts.has_exact) out.add("error.exact", rms_error(s, t), "m/s");
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
