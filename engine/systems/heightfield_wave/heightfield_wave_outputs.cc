// What shallow water gives out, and its drawing.
#include <algorithm>
#include <cmath>

#include "engine/core/outputs/outputs_of.h"
#include "engine/systems/heightfield_wave/columns.h"
#include "engine/systems/heightfield_wave/heightfield_wave.h"

namespace truestep::heightfield_wave {

using namespace columns;

struct HeightfieldWave::Whole {
  double mass = 0, kinetic = 0, potential = 0, px = 0;
  std::optional<double> py;
  double low = NAN, high = NAN, deepest = 0, fastest = 0, wet = 0, cfl = 0, substeps = 0;
  std::optional<double> error;
  double energy() const { return kinetic + potential; }
};

const OutputTable& HeightfieldWave::outputs() {
  using H = HeightfieldWave;
  using W = Whole;
  // A number for every cell: value(system, state, cell).
  const auto of_cells = [](auto value) {
    return computed_by<H>([value](const H& h, const State& s, ShownRows rows, double* out) {
      for (size_t i = 0; i < rows.count; ++i) out[i] = value(h, s, i);
    });
  };
  static const OutputTable kTable =
      OutputsOf<H>("a cell, x fastest")
          .part("", &H::cells)
          .field({"surface", "m"},
                 of_cells([](const H& h, const State& s, size_t i) { return h.bed(i) + s.f64(kDepth)[i]; }),
                 "height of the water's surface, or of dry ground")
          .field({"depth", "m"}, column(kDepth), "depth of the water")
          .field({"velocity", "m/s", Scalar::f64, 3},
                 computed_by<H>([](const H& h, const State& s, ShownRows rows, double* out) {
                   for (size_t i = 0; i < rows.count; ++i) store3(out, i, h.velocity(s, i));
                 }),
                 "mean velocity over the depth")
          .field({"speed", "m/s"},
                 of_cells([](const H& h, const State& s, size_t i) { return norm(h.velocity(s, i)); }),
                 "its magnitude")
          .field({"bed", "m"}, of_cells([](const H& h, const State&, size_t i) { return h.bed(i); }),
                 "height of the ground")
          .measured(&H::whole, {{"mass", "kg", &W::mass, "of the water in the basin"},
                                {"energy.kinetic", "J", &W::kinetic, "of its mean velocity"},
                                {"energy.potential", "J", &W::potential, "in gravity, from height 0"},
                                {"energy.total", "J", &W::energy, "their sum"},
                                {"momentum.x", "kg m/s", &W::px, "of the water along x"},
                                {"momentum.y", "kg m/s", &W::py, "of the water along y"},
                                {"surface.min", "m", &W::low, "lowest surface of a wet cell"},
                                {"surface.max", "m", &W::high, "highest surface of a wet cell"},
                                {"depth.max", "m", &W::deepest, "largest depth"},
                                {"speed.max", "m/s", &W::fastest, "largest speed"},
                                {"wet", "1", &W::wet, "fraction of the cells that are wet"},
                                {"cfl", "1", &W::cfl, "cells crossed by the fastest wave in a substep"},
                                {"substeps", "1", &W::substeps, "substeps of the last step"},
                                {"error.exact", "m", &W::error,
                                 "mean difference from the depth under the scene's exact surface"}})
          .build();
  return kTable;
}

const Outputs& heightfield_wave_outputs() {
  static const Outputs kDescribed = HeightfieldWave::outputs().described();
  return kDescribed;
}

PartInfo HeightfieldWave::cells() const {
  const shallow::Basin& b = basin_;
  const Vec3 corner = def_.origin.value_or(Vec3{});
  PartInfo part;
  part.kind = PartInfo::Kind::grid;
  part.max_rows = b.count();
  for (size_t a = 0; a < b.dimensions; ++a) part.lattice.counts[a] = static_cast<uint32_t>(b.cells[a]);
  part.lattice.origin = {b.centre(0, 0), b.dimensions == 2 ? b.centre(1, 0) : corner.y, corner.z};
  part.lattice.spacing = {b.spacing[0], b.spacing[1], 1};
  part.lattice.centring = Lattice::Centring::cells;
  return part;
}

Vec3 HeightfieldWave::velocity(const State& s, size_t cell) const {
  const double depth = s.f64(kDepth)[cell], share = depth > basin_.dry ? 1 / depth : 0;
  return {share * s.f64(kX)[cell], basin_.dimensions == 2 ? share * s.f64(kY)[cell] : 0, 0};
}

HeightfieldWave::Whole HeightfieldWave::whole(const State& s, double t) const {
  const auto h = s.f64(kDepth);
  const bool plane = basin_.dimensions == 2;
  Whole out;
  double volume = 0, px = 0, py = 0, fastest = 0, wet = 0;
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < h.size(); ++i) {
    const double z = bed(i), qx = s.f64(kX)[i], qy = plane ? s.f64(kY)[i] : 0;
    volume += h[i], px += qx, py += qy;
    out.potential += h[i] * (z + 0.5 * h[i]);
    out.deepest = std::max(out.deepest, h[i]);
    if (h[i] <= basin_.dry) continue;
    const double square = (qx * qx + qy * qy) / (h[i] * h[i]);
    out.kinetic += 0.5 * h[i] * square, fastest = std::max(fastest, square), wet += 1;
    low = std::min(low, z + h[i]), high = std::max(high, z + h[i]);
  }
  const double mass = def_.density * basin_.cell_area(), cells = static_cast<double>(h.size());
  out.kinetic *= mass, out.potential *= mass * basin_.gravity;
  out.mass = mass * volume, out.px = mass * px;
  if (plane) out.py = mass * py;
  if (wet > 0) out.low = low, out.high = high;
  out.fastest = std::sqrt(fastest), out.wet = wet / cells;
  out.cfl = s.f64(numbers_)[kCfl], out.substeps = s.f64(numbers_)[kSubsteps];
  if (!texts_.has_exact) return out;
  std::vector<double> exact(h.size());
  BasinTexts::sample(texts_.exact, basin_, t, exact.data());
  double sum = 0;
  for (size_t i = 0; i < h.size(); ++i) sum += std::abs(h[i] - std::max(0.0, exact[i] - bed(i)));
  out.error = sum / cells;
  return out;
}

void HeightfieldWave::draw(const State&, double, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::constant)) out.parts.resize(parts().size());
}

}  // namespace truestep::heightfield_wave
