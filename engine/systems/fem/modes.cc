// Natural frequencies of a body at rest: K y = (2 pi f)^2 M y by subspace iteration on K + shift M,
// factorised once (Bathe 1996, section 11.6). Done when a system is built, never in a step.
#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/math/solvers/block_ldlt.h"
#include "engine/math/solvers/dense_symmetric.h"
#include "engine/systems/fem/fem.h"

namespace truestep::fem {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kMostIterations = 300;
constexpr double kAccurate = 1e-10;  // relative change of a squared frequency between iterations
constexpr double kShift =
    1e-11;  // share of the highest squared frequency; for rigid motions, whose stiffness is 0

}  // namespace

std::vector<double> natural_frequencies(const FemField& field, int count) {
  using Columns = FemColumns;
  static const ThreadArena kSerial(1);
  const Body& b = field.body();
  const State s = field.initial_state();
  const auto w = s.f64(Columns::inverse_mass);
  const size_t n = 3 * w.size();
  Workspace workspace;
  Evaluation e{workspace, kSerial};
  BlockSparse dfdx, dfdv;
  field.jacobian_pattern(s, dfdx, dfdv);
  field.jacobian({0, s.f64(Columns::position), s.f64(Columns::velocity), s}, dfdx, dfdv, e);

  const double highest = std::pow(field.stiffness(s)->omega, 2), shift = kShift * highest;
  const auto free = [&](size_t k) { return w[k / 3] > 0 && !(b.axes[k / 3] >> (k % 3) & 1); };
  BlockSparse a = dfdx;
  size_t unknowns = 0;
  for (size_t i = 0; i < w.size(); ++i) {
    for (auto k = a.row_begin(i); k < a.row_begin(i + 1); ++k) {
      const auto block = a.block(k);
      for (size_t c = 0; c < 9; ++c) {
        const bool both = free(3 * i + c % 3) && free(3 * a.column(k) + c / 3);
        block[c] = both ? -block[c] : 0;
      }
    }
    const auto diagonal = a.block(a.diagonal_slot(i));
    for (size_t c = 0; c < 3; ++c) {
      diagonal[4 * c] += (free(3 * i + c) ? shift : highest) * b.masses[i];
      unknowns += free(3 * i + c);
    }
  }
  const size_t wanted = std::min(static_cast<size_t>(count), unknowns);
  const size_t m = std::min({wanted + 8, 2 * wanted + 2, unknowns});
  if (wanted == 0) return {};
  BlockLdlt factors;
  factors.analyze(a);
  if (factors.factorize(a) != BlockLdlt::Outcome::positive_definite) {
    throw Error("scene_invalid", "the body's stiffness at rest is not positive definite",
                {"/modes", "no_frequencies", "the body's stiffness at rest is not positive definite", "", "",
                 "", ""});
  }

  DenseColumns y(n, m), my(n, m);
  uint64_t seed = 1;
  for (size_t c = 0; c < m; ++c) {
    for (size_t r = 0; r < n; ++r) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      y(r, c) = free(r) ? static_cast<double>(seed >> 11) * 0x1p-52 - 1 : 0;
    }
  }
  const auto times_mass = [&] {
    for (size_t c = 0; c < m; ++c) {
      for (size_t r = 0; r < n; ++r) my(r, c) = b.masses[r / 3] * y(r, c);
    }
  };
  const auto symmetric = [m](const DenseColumns& all) {
    DenseColumns half(m, m);
    for (size_t c = 0; c < m; ++c) {
      for (size_t r = 0; r < m; ++r) half(r, c) = 0.5 * (all(r, c) + all(c, r));
    }
    return half;
  };
  times_mass();
  std::vector<double> last(m, 0.0);
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    // x = A^-1 M y; A projected onto their span is x^T M y.
    DenseColumns x(n, m);
    for (size_t c = 0; c < m; ++c) factors.solve(my.column(c), x.column(c));
    const DenseColumns turned = x.transposed(), stiff = turned * my;
    y = x;
    times_mass();
    const DenseEigen ritz = generalized_eigen(symmetric(stiff), symmetric(turned * my));
    y = x * ritz.vectors;
    times_mass();
    double moved = 0;
    for (size_t k = 0; k < wanted; ++k) {
      moved = std::max(moved, std::abs(ritz.values[k] - last[k]) / std::abs(ritz.values[k]));
    }
    last = ritz.values;
    if (moved < kAccurate) break;
  }
  std::vector<double> out;
  for (size_t k = 0; k < wanted; ++k) {
    const double squared = last[k] - shift;
    // That of a rigid motion is rounding.
    out.push_back(squared > 10 * shift ? std::sqrt(squared) / (2 * kPi) : 0);
  }
  return out;
}

}  // namespace truestep::fem
