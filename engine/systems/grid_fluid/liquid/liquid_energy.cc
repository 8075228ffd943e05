// Undoing compression displaces particles, mostly upwards: what the flow has packed too densely it has also
// let sink too far, and by the time that is undone another part of the liquid gains the height. Left at that,
// waves grow: it fed one of 33 J with 27 J in a minute, of which 7 J stayed (a column of 0.4 x 1 m collapsed
// in a box of 1.6 m, apic, 64 cells). So the displacement does no work: what it lifts the liquid by is taken
// from the motion relative to the mean velocity, by one factor, which keeps momentum and a liquid that falls
// or drifts as one. It is taken in small parts, so that a pool that is settling does not stop a drop; and
// what it lowers the liquid by counts against what it lifts it by for about half a period of the box's
// longest wave.
#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/systems/grid_fluid/liquid/liquid_flow.h"

namespace truestep::grid_fluid {

namespace {
constexpr size_t kRowsPerTask = 4096;
/// Of the energy of the relative motion, at most, in a substep.
constexpr double kMostTaken = 0.02;
}  // namespace

void LiquidFlow::pay_for_lift(LiquidFields& f, double lift, double h) {
  *f.lifted += lift;
  const mac::MacGrid& g = model_->grid;
  const size_t d = g.dimensions;
  const double gravity = norm(model_->gravity);
  double longest = 0;
  for (size_t a = 0; a < d; ++a) longest = std::max(longest, g.extent(a));
  constexpr double kPi = 3.14159265358979323846;
  // Infinite without gravity, against which nothing is lifted.
  const double half_period = kPi * std::sqrt(longest / gravity);
  *f.owed = (*f.owed + lift) / (1 + h / half_period);
  if (!(*f.owed > 0)) return;
  const auto sum = [&](auto&& of) {
    const auto block = [&](size_t begin, size_t end) {
      double out = 0;
      for (size_t p = begin; p < end; ++p) out += of(now_.data() + width_ * p + d);
      return out;
    };
    return arena_->sum_blocks(rows_, kRowsPerTask, std::ref(block));  // by reference, so as not to allocate
  };
  const auto energy = [d](const double* v) {
    double square = 0;
    for (size_t a = 0; a < d; ++a) square += v[a] * v[a];
    return 0.5 * square;
  };
  double mean[3] = {}, moving = sum(energy);
  const auto n = static_cast<double>(rows_);
  for (size_t a = 0; a < d; ++a) {
    mean[a] = sum([a](const double* v) { return v[a]; }) / n;
    moving -= 0.5 * n * mean[a] * mean[a];
  }
  if (!(moving > 0)) return;
  const double taken = std::min(*f.owed, kMostTaken * moving), keep = std::sqrt(1 - taken / moving);
  *f.owed -= taken;
  arena_->for_blocks(rows_, kRowsPerTask, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      double* v = particle(now_, p) + d;
      for (size_t a = 0; a < d; ++a) v[a] = mean[a] + keep * (v[a] - mean[a]);
      if (!affine_) continue;
      for (size_t k = d; k < width_ - d; ++k) v[k] *= keep;
    }
  });
}

}  // namespace truestep::grid_fluid
