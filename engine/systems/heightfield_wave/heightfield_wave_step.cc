// A step: substeps of two stages, as short as the fastest wave requires (Heun; kernels/shallow).
#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/systems/heightfield_wave/columns.h"
#include "engine/systems/heightfield_wave/heightfield_wave.h"

namespace truestep::heightfield_wave {

using shallow::Water;
using namespace columns;

Water HeightfieldWave::water(State& s) const {
  return {s.f64(kDepth).data(), s.f64(kX).data(), basin_.dimensions == 2 ? s.f64(kY).data() : nullptr};
}

Water HeightfieldWave::rows(std::vector<double>& of) const {
  const size_t n = basin_.count();
  return {of.data(), of.data() + n, basin_.dimensions == 2 ? of.data() + 2 * n : nullptr};
}

void HeightfieldWave::bind(Work& w) const {
  const size_t n = basin_.count() * (1 + basin_.dimensions), padded = basin_.padded();
  w.p.z = bed_;
  w.p.h.resize(padded), w.p.eta.resize(padded), w.p.u.resize(padded);
  // Nothing flows across a line.
  if (basin_.dimensions == 2) {
    w.p.v.resize(padded);
  } else {
    w.p.v.assign(padded, 0);
  }
  w.rates.resize(n), w.before.resize(n), w.row_speeds.resize(2 * basin_.cells[1]);
}

void HeightfieldWave::add(const Water& water, const Work& work, double h, const ThreadArena& arena) const {
  const size_t n = basin_.count();
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    const double* rate = work.rates.data();
    for (size_t i = begin; i < end; ++i) water.h[i] = std::max(0.0, water.h[i] + h * rate[i]);
    for (size_t i = begin; i < end; ++i) water.qx[i] += h * rate[n + i];
    if (!water.qy) return;
    for (size_t i = begin; i < end; ++i) water.qy[i] += h * rate[2 * n + i];
  });
}

void HeightfieldWave::finish(const Water& water, const Work& work, double friction, double h,
                             const ThreadArena& arena) const {
  const size_t n = basin_.count();
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    const double* before = work.before.data();
    for (size_t i = begin; i < end; ++i) {
      const double depth = 0.5 * (before[i] + water.h[i]), qx = 0.5 * (before[n + i] + water.qx[i]);
      const double qy = water.qy ? 0.5 * (before[2 * n + i] + water.qy[i]) : 0;
      const bool wet = depth > basin_.dry;
      // Backward Euler for q' = -friction |q| q / depth^2, with |q| lagged.
      const double slowed = 1 + h * friction * std::sqrt(qx * qx + qy * qy) / (depth * depth);
      const double kept = wet ? 1 / slowed : 0;
      water.h[i] = depth, water.qx[i] = kept * qx;
      if (water.qy) water.qy[i] = kept * qy;
    }
  });
}

std::optional<double> HeightfieldWave::limit(Limit which, const State& s, double h) const {
  if (which != Limit::step_seconds) return std::nullopt;
  const std::span<const double> depth = s.f64(kDepth), qx = s.f64(kX);
  const std::span<const double> qy = basin_.dimensions == 2 ? s.f64(kY) : std::span<const double>();
  double deepest = 0, fastest = 0;
  for (size_t i = 0; i < depth.size(); ++i) {
    deepest = std::max(deepest, depth[i]);
    if (!(depth[i] > basin_.dry)) continue;
    fastest = std::max(fastest, std::abs(qx[i]) / depth[i]);
    if (!qy.empty()) fastest = std::max(fastest, std::abs(qy[i]) / depth[i]);
  }
  const double wave = std::sqrt(basin_.gravity * deepest) + fastest;
  double crossings = 0;
  for (size_t a = 0; a < basin_.dimensions; ++a) crossings += wave / basin_.spacing[a];
  return heightfield_substep_seconds(def_) * std::max(1.0, std::ceil(h * crossings / def_.cfl));
}

void HeightfieldWave::advance(State& s, const StepInput& in) const {
  auto& work = in.workspace.object<Work>("heightfield_wave");
  bind(work);
  const Water now = water(s), rate = rows(work.rates), before = rows(work.before);
  const auto numbers = s.f64(numbers_);
  const size_t n = basin_.count();
  const auto copy = [&](const Water& from, const Water& to) {
    std::copy_n(from.h, n, to.h), std::copy_n(from.qx, n, to.qx);
    if (from.qy) std::copy_n(from.qy, n, to.qy);
  };
  const auto crossing = [&] {
    primitives(basin_, now, work.p, in.arena);
    return shallow::rates(basin_, work.p, rate, work.row_speeds.data(), in.arena);
  };
  double left = in.h, highest = 0;
  int taken = 0;
  while (left > 0) {
    copy(now, before);
    double speed = crossing();
    // A first stage may raise faster waves than the substep was chosen for: then it is repeated.
    for (double h = 0;;) {
      const double wanted = std::ceil(left * speed / def_.cfl - 1e-9);
      if (!(wanted + taken <= kMostSubsteps)) {
        Instability e(id_, "depth", -1,
                      "the fastest wave crosses " + short_number(left * speed) +
                          " cells in a step: more than " + std::to_string(kMostSubsteps) +
                          " substeps would be needed");
        if (std::isfinite(wanted)) e.suggested_dt = 0.5 * in.h * kMostSubsteps / (wanted + taken);
        throw e;
      }
      h = left / std::max(1.0, wanted);
      add(now, work, h, in.arena);
      const double raised = crossing();
      if (h * raised <= 0.5 || raised <= speed) {
        add(now, work, h, in.arena);
        finish(now, work, numbers[kFriction], h, in.arena);
        left = wanted <= 1 ? 0 : left - h;
        highest = std::max(highest, h * std::max(speed, raised));
        ++taken;
        break;
      }
      copy(before, now);
      crossing();
      speed = raised;
    }
  }
  numbers[kSubsteps] = taken, numbers[kCfl] = highest;
}

}  // namespace truestep::heightfield_wave
