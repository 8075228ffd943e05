// Observables, fields and drawing of shallow water.
#include <algorithm>
#include <cmath>

#include "engine/systems/heightfield_wave/heightfield_wave.h"

namespace truestep::heightfield_wave {

namespace {
enum Observed : State::Column { kObservedDepth, kObservedX, kObservedY };
}

FieldView HeightfieldWave::field(const State& s, size_t, size_t field, std::vector<double>& scratch) const {
  const auto h = s.f64(kObservedDepth);
  const size_t n = h.size();
  if (field == 1) return {h.data(), Scalar::f64, n, 1};
  const uint32_t width = field == 2 ? 3 : 1;
  scratch.assign(width * n, 0);
  for (size_t i = 0; i < n; ++i) {
    if (field == 0 || field == 4) {
      scratch[i] = bed(i) + (field == 0 ? h[i] : 0);
      continue;
    }
    const double share = h[i] > basin_.dry ? 1 / h[i] : 0;
    const double u = share * s.f64(kObservedX)[i],
                 v = basin_.dimensions == 2 ? share * s.f64(kObservedY)[i] : 0;
    if (field == 2) {
      scratch[3 * i] = u, scratch[3 * i + 1] = v;
    } else {
      scratch[i] = std::sqrt(u * u + v * v);
    }
  }
  return {scratch.data(), Scalar::f64, n, width};
}

void HeightfieldWave::observe(const State& s, double t, Observables& out) const {
  const auto h = s.f64(kObservedDepth);
  const bool plane = basin_.dimensions == 2;
  double volume = 0, kinetic = 0, potential = 0, px = 0, py = 0, deepest = 0, fastest = 0, wet = 0;
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < h.size(); ++i) {
    const double z = bed(i), qx = s.f64(kObservedX)[i], qy = plane ? s.f64(kObservedY)[i] : 0;
    volume += h[i], px += qx, py += qy;
    potential += h[i] * (z + 0.5 * h[i]);
    deepest = std::max(deepest, h[i]);
    if (h[i] <= basin_.dry) continue;
    const double square = (qx * qx + qy * qy) / (h[i] * h[i]);
    kinetic += 0.5 * h[i] * square, fastest = std::max(fastest, square), wet += 1;
    low = std::min(low, z + h[i]), high = std::max(high, z + h[i]);
  }
  const double mass = def_.density * basin_.cell_area();
  kinetic *= mass, potential *= mass * basin_.gravity;
  out.add("mass", mass * volume, "kg");
  out.add("energy.kinetic", kinetic, "J");
  out.add("energy.potential", potential, "J");
  out.add("energy.total", kinetic + potential, "J");
  out.add("momentum.x", mass * px, "kg m/s");
  if (plane) out.add("momentum.y", mass * py, "kg m/s");
  out.add("surface.min", wet > 0 ? low : NAN, "m");
  out.add("surface.max", wet > 0 ? high : NAN, "m");
  out.add("depth.max", deepest, "m");
  out.add("speed.max", std::sqrt(fastest), "m/s");
  out.add("wet", wet / static_cast<double>(h.size()), "1");
  out.add("cfl", s.f64(numbers_)[2], "1");
  out.add("substeps", s.f64(numbers_)[1], "1");
  if (!texts_.has_exact) return;
  std::vector<double> exact(h.size());
  BasinTexts::sample(texts_.exact, basin_, t, exact.data());
  double sum = 0;
  for (size_t i = 0; i < h.size(); ++i) sum += std::abs(h[i] - std::max(0.0, exact[i] - bed(i)));
  out.add("error.exact", sum / static_cast<double>(h.size()), "m");
}

void HeightfieldWave::draw(const State&, double, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::constant)) out.parts.resize(parts().size());
}

}  // namespace truestep::heightfield_wave
