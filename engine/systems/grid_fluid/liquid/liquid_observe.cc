// What a liquid shows and measures, and its warnings.
#include <algorithm>

#include "engine/base/text/short_number.h"
#include "engine/core/mass_points.h"
#include "engine/systems/grid_fluid/fluid_rows.h"
#include "engine/systems/grid_fluid/grid_fluid.h"
#include "engine/systems/grid_fluid/liquid/liquid.h"

namespace truestep::grid_fluid {

const OutputTable& Liquid::outputs() {
  using L = Liquid;
  static const OutputTable kTable =
      OutputsOf<L>("a particle")
          .part("", [](const L& l) { return points_part(l.capacity_); })
          .rows(present_rows(kPosition))
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(kPosition),
                 "of a liquid's particle")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(&L::velocity_), "")
          .field({"speed", "m/s"},
                 computed_by<L>([](const L& l, const State& s, ShownRows rows, double* out) {
                   for (size_t i = 0; i < rows.count; ++i) out[i] = norm(load3(s.f64(l.velocity_).data(), i));
                 }),
                 "")
          .field({"pressure", "Pa"}, computed_by<L>([](const L& l, const State& s, ShownRows, double* out) {
                   l.of_cells(s, l.pressure_, l.model_.def.density, out);
                 }),
                 "")
          .field({"fill", "1"}, computed_by<L>([](const L& l, const State& s, ShownRows, double* out) {
                   l.of_cells(s, l.fill_, 1, out);
                 }),
                 "of a liquid: fraction of the particle's cell that is filled")
          .field({"dye", "1"}, column(&L::dye_),
                 "of a liquid's particle, if bodies, emitters or sides set one")
          .field_when([](const L& l) { return l.dye_ != 0; })
          .field({"id", "1", Scalar::u64}, column(&L::id_column_),
                 "of a liquid's particle where they come and go: never reused")
          .field_when([](const L& l) { return l.id_column_ != 0; })
          .measured(&L::measure, kFluidRows)
          .build();
  return kTable;
}

void Liquid::of_cells(const State& s, State::Column column, double scale, double* out) const {
  const mac::MacGrid& g = model_.grid;
  const double *x = s.f64(kPosition).data(), *of_cells = s.f64(column).data();
  for (size_t i = 0; i < rows(s); ++i) {
    size_t cell[3] = {};
    for (size_t a = 0; a < g.dimensions; ++a) {
      const double place = (x[3 * i + a] - g.origin[a]) / g.spacing[a];
      cell[a] = static_cast<size_t>(std::clamp(place, 0.0, static_cast<double>(g.cells[a] - 1)));
    }
    out[i] = scale * of_cells[g.at(cell[0], cell[1], cell[2])];
  }
}

FluidNumbers Liquid::measure(const State& s, double) const {
  const double *x = s.f64(kPosition).data(), *v = s.f64(velocity_).data();
  MassPoints all(model_.gravity);
  const size_t n = rows(s);
  for (size_t i = 0; i < n; ++i) all.add(mass_, load3(x, i), load3(v, i));
  const auto numbers = s.f64(numbers_);
  FluidNumbers out{.kinetic = all.kinetic,
                   .fastest = all.speed(),
                   .cfl = numbers[kLiquidCfl],
                   .substeps = numbers[kLiquidSubsteps],
                   .mass = mass_ * static_cast<double>(n),
                   .pressure_iterations = numbers[kLiquidIterations],
                   .pressure_residual = numbers[kLiquidResidual],
                   .gravity = all.height,
                   .energy = all.total(),
                   .momentum = all.momentum,
                   .centre = all.centre(),
                   .low = all.lowest(),
                   .high = all.highest(),
                   .mean_compression = numbers[kMeanCompression],
                   .max_compression = numbers[kMaxCompression],
                   .lifted = mass_ * numbers[kLifted],
                   .density_iterations = numbers[kDensityIterations]};
  if (dye_) {
    double dye = 0;
    for (const double q : s.f64(dye_)) dye += q;
    out.dye = dye * mass_ / model_.def.density;
  }
  if (!counts_) return out;
  const auto counted = [c = s.span<uint64_t>(counts_)](Count k) { return static_cast<double>(c[k]); };
  out.count = static_cast<double>(n);
  out.emitted = counted(kEmitted), out.killed = counted(kKilled);
  out.left = counted(kLeft), out.refused = counted(kRefused);
  return out;
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
