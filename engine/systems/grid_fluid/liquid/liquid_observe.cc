// What a liquid shows and measures, and its warnings.
#include <algorithm>

#include "engine/base/text/short_number.h"
#include "engine/core/mass_points.h"
#include "engine/systems/grid_fluid/grid_fluid.h"
#include "engine/systems/grid_fluid/liquid/liquid.h"

namespace truestep::grid_fluid {

FieldView Liquid::field(const State& s, size_t, size_t field, std::vector<double>& scratch) const {
  const double* x = s.f64(kPosition).data();
  const size_t n = rows(s);
  if (field == 0) return {x, Scalar::f64, n, 3};
  const double* v = s.f64(velocity_).data();
  if (field == 1) return {v, Scalar::f64, n, 3};
  if (field == 5 && dye_) return {s.f64(dye_).data(), Scalar::f64, n, 1};
  if (field >= 5) return {s.bytes(id_column_).data(), Scalar::u64, n, 1};
  scratch.resize(n);
  const mac::MacGrid& g = model_.grid;
  const double* of_cells = s.f64(field == 3 ? pressure_ : fill_).data();
  const double scale = field == 3 ? model_.def.density : 1;
  for (size_t i = 0; i < n; ++i) {
    if (field == 2) {
      scratch[i] = norm(load3(v, i));
      continue;
    }
    size_t cell[3] = {};
    for (size_t a = 0; a < g.dimensions; ++a) {
      const double place = (x[3 * i + a] - g.origin[a]) / g.spacing[a];
      cell[a] = static_cast<size_t>(std::clamp(place, 0.0, static_cast<double>(g.cells[a] - 1)));
    }
    scratch[i] = scale * of_cells[g.at(cell[0], cell[1], cell[2])];
  }
  return {scratch.data(), Scalar::f64, n, 1};
}

void Liquid::observe(const State& s, double, Observables& out) const {
  const double *x = s.f64(kPosition).data(), *v = s.f64(velocity_).data();
  MassPoints all(model_.gravity);
  const size_t count = rows(s);
  for (size_t i = 0; i < count; ++i) all.add(mass_, load3(x, i), load3(v, i));
  const auto n = static_cast<double>(count);
  all.observe_energy(out);
  add_vector(out, "momentum", all.momentum, "kg m/s");
  all.observe_centre(out);
  all.observe_extent(out);
  out.add("mass", mass_ * n, "kg");
  out.add("speed.max", all.speed(), "m/s");
  const auto numbers = s.f64(numbers_);
  out.add("density.mean_error", numbers[kMeanCompression], "1");
  out.add("density.max_error", numbers[kMaxCompression], "1");
  out.add("density.lift", mass_ * numbers[kLifted], "J");
  out.add("cfl", numbers[kLiquidCfl], "1");
  out.add("substeps", numbers[kLiquidSubsteps], "1");
  out.add("pressure.iterations", numbers[kLiquidIterations], "1");
  out.add("pressure.residual", numbers[kLiquidResidual], "1");
  out.add("density.iterations", numbers[kDensityIterations], "1");
  if (dye_) {
    double dye = 0;
    for (const double q : s.f64(dye_)) dye += q;
    out.add("dye.total", dye * mass_ / model_.def.density, "1");
  }
  if (!counts_) return;
  const auto c = s.span<uint64_t>(counts_);
  out.add("count", n, "1");
  out.add("emitted", static_cast<double>(c[kEmitted]), "1");
  out.add("killed", static_cast<double>(c[kKilled]), "1");
  out.add("left", static_cast<double>(c[kLeft]), "1");
  out.add("refused", static_cast<double>(c[kRefused]), "1");
}

void Liquid::draw(const State&, double t, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::constant)) {
    const mac::MacGrid& g = model_.grid;
    out.parts.resize(parts().size());
    out.parts[0].point_radius = 0.5 * g.spacing[0] / model_.def.particles_per_axis;
    if (g.dimensions == 2) {
      for (PartDrawing& part : out.parts) part.space = PartDrawing::Space::plane;
    }
  }
  if (!wants(wishes, Wish::obstacles)) return;
  ObstaclePlaces now;
  model_.texts.place_obstacles(model_.def.obstacles, t, now);
  draw_obstacles(now.obstacles, out);
}

void Liquid::warn(const State& s, double h, std::vector<Warning>& out) const {
  const auto numbers = s.f64(numbers_);
  warn_of_crossing(numbers[kLiquidCfl], kMostTraced, h / std::max(1.0, numbers[kLiquidSubsteps]), out);
  // Twice the mean of a dam break at its thinnest.
  constexpr double kMostCompressed = 0.05;
  if (!(numbers[kMeanCompression] > kMostCompressed)) return;
  out.push_back({.quantity = "density.mean_error",
                 .value = numbers[kMeanCompression],
                 .limit = kMostCompressed,
                 .detail = "cells hold " + short_number(100 * numbers[kMeanCompression]) +
                           " % more liquid than fits into them: more cells or a smaller cfl would do"});
}

}  // namespace truestep::grid_fluid
