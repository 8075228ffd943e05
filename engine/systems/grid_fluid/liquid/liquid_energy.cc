// Undoing compression displaces particles, mostly upwards: what the flow has packed too densely it has also
// let sink too far, and by the time that is undone another part of the liquid gains the height. Left at that,
// waves grow: it fed one of 33 J with 27 J in a minute, of which 7 J stayed (a column of 0.4 x 1 m collapsed
// in a box of 1.6 m, apic, 64 cells). So the displacement does no work: what it lifts the liquid by is taken
// from the motion relative to the mean velocity, by one factor, which keeps momentum and a liquid that falls
// or drifts as one. It is taken in small parts, so that a body that is settling does not stop, and what it
// lowers the liquid by counts against what it lifts it by for about half a period of the box's longest wave.
// Each connected body of liquid pays for itself: particles carry what they owe, and their body shares it
// evenly. Beyond the surface of every body nothing is paid.
#include <algorithm>
#include <cmath>

#include "engine/kernels/mac/connected.h"
#include "engine/systems/grid_fluid/liquid/liquid_flow.h"

namespace truestep::grid_fluid {

namespace {
/// Of the energy of the relative motion, at most, in a substep.
constexpr double kMostTaken = 0.02;
}  // namespace

void LiquidFlow::number_bodies() {
  // Bodies are parts of the matrix that no pressure connects.
  const auto& faces = solids_->any() ? shift_ : factor_;
  const size_t count =
      mac::number_bodies(model_->grid, liquid_.data(), {faces[0].data(), faces[1].data(), faces[2].data()},
                         body_.data(), runs_, *arena_);
  bodies_.assign(count + 1, {});
}

void LiquidFlow::pay_for_lift(double h) {
  const mac::MacGrid& g = model_->grid;
  const size_t d = g.dimensions, owed = width_ - 1;
  double longest = 0;
  for (size_t a = 0; a < d; ++a) longest = std::max(longest, g.extent(a));
  constexpr double kPi = 3.14159265358979323846;
  const double half_period = kPi * std::sqrt(longest / norm(model_->gravity)),
               fade = 1 / (1 + h / half_period);
  const auto first_cell = [&](size_t j, size_t k) { return g.cells[0] * (j + g.cells[1] * k); };

  // Sums over the particles that a cell had at the start of the substep, in arrays that are free by now.
  double *energy = mass_[0].data(), *owing = mass_[1].data();
  mac::for_rows(g, mac::kCentre, *arena_, [&](size_t at, size_t j, size_t k, size_t n) {
    for (size_t i = 0; i < n; ++i) {
      const size_t cell = first_cell(j, k) + i, begin = order_.start(cell), end = order_.start(cell + 1);
      if (begin == end) continue;
      double square = 0, due = 0, sum[3] = {};
      for (size_t p = begin; p < end; ++p) {
        const double* v = particle(now_, p) + d;
        due += v[owed - d];
        for (size_t a = 0; a < d; ++a) sum[a] += v[a], square += v[a] * v[a];
      }
      energy[at + i] = 0.5 * square, owing[at + i] = due;
      for (size_t a = 0; a < d; ++a) before_[a][at + i] = sum[a];
    }
  });
  // One cell after the other, so that sums do not depend on the number of threads.
  for (size_t k = 0, cell = 0; k < g.cells[2]; ++k) {
    for (size_t j = 0; j < g.cells[1]; ++j) {
      const size_t row = g.at(0, j, k);
      for (size_t at = row; at < row + g.cells[0]; ++at, ++cell) {
        const uint32_t count = order_.start(cell + 1) - order_.start(cell);
        if (count == 0 || body_[at] == 0) continue;
        LiquidBody& b = bodies_[body_[at]];
        b.particles += count, b.moving += energy[at], b.owed += owing[at];
        for (size_t a = 0; a < d; ++a) b.mean[a] += before_[a][at];
      }
    }
  }
  for (LiquidBody& b : bodies_) {
    if (!(b.particles > 0)) continue;
    b.owed *= fade;
    for (size_t a = 0; a < d; ++a)
      b.mean[a] /= b.particles, b.moving -= 0.5 * b.particles * b.mean[a] * b.mean[a];
    if (b.owed > 0 && b.moving > 0) {
      const double taken = std::min(b.owed, kMostTaken * b.moving);
      b.owed -= taken, b.keep = std::sqrt(1 - taken / b.moving);
    }
    b.owed /= b.particles;
  }
  mac::for_rows(g, mac::kCentre, *arena_, [&](size_t at, size_t j, size_t k, size_t n) {
    for (size_t i = 0; i < n; ++i) {
      const size_t cell = first_cell(j, k) + i;
      const LiquidBody& b = bodies_[body_[at + i]];
      for (size_t p = order_.start(cell); p < order_.start(cell + 1); ++p) {
        double* v = particle(now_, p) + d;
        v[owed - d] = body_[at + i] == 0 ? v[owed - d] * fade : b.owed;
        if (b.keep == 1) continue;
        for (size_t a = 0; a < d; ++a) v[a] = b.mean[a] + b.keep * (v[a] - b.mean[a]);
        for (size_t m = d; m < owed - d; ++m) v[m] *= b.keep;
      }
    }
  });
}

}  // namespace truestep::grid_fluid
