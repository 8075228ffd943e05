// Projective dynamics (Bouaziz, Martin, Liu, Kavan, Pauly 2014; for springs: Liu, Bargteil, O'Brien, Kavan
// 2013) in its quasi-Newton form (Liu, Bouaziz, Kavan 2017, "Quasi-Newton methods for real-time simulation of
// hyperelastic materials", algorithm 1):
//   x <- x - H r(x),   H = L-BFGS of the last 5 moves on top of A^-1,   A = M / h^2 + B
//   (core/equations/stiffness_bound.h).
// Without the moves this is a global step after a local one. A is the same for x, y and z and constant while
// masses, stiffness and h are: it is factorised once. A move is taken if the slope along it has fallen to
// half in magnitude or has not changed sign, and otherwise shortened by the secant rule, which needs no
// energies (instead of the paper's Armijo rule). Iterations end at a residual of `newton_tolerance` times the
// first. Moves are forgotten at the step's end, so that a step depends only on the state.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/equations/stiffness_bound.h"
#include "engine/integrators/descent/descent.h"
#include "engine/integrators/table/methods.h"
#include "engine/math/solvers/block_ldlt.h"

namespace truestep {

namespace {

constexpr size_t kMoves = 5;
constexpr int kMostShortenings = 8;
constexpr double kSlopeLeft = 0.5;

// A and its factors; a cache of something determined by the state and h.
struct Global {
  BlockSparse a;
  std::vector<double> factored;
  BlockLdlt factors;

  void prepare(const ForceField& field, const StiffnessBound& bound, const State& state, double h) {
    if (a.empty()) bound.bound_pattern(a);
    bound.bound(state, h, a);
    const auto w = field.inverse_mass(state);
    const auto values = a.values();
    for (size_t i = 0; i < w.size(); ++i) {
      for (auto s = a.row_begin(i); s < a.row_begin(i + 1); ++s) {
        if (!(w[i] > 0) || !(w[a.column(s)] > 0)) values[s] = 0;
      }
      values[a.diagonal_slot(i)] += w[i] > 0 ? 1 / (w[i] * h * h) : 1;
    }
    if (factored.size() == values.size() && std::equal(values.begin(), values.end(), factored.begin()))
      return;
    factored.assign(values.begin(), values.end());
    factors.factorize(a);
  }
};

// The last moves s = dx and the resulting changes y = dr.
struct Moves {
  std::array<std::span<double>, kMoves> s, y;
  std::array<double, kMoves> per_sy{};
  size_t next = 0, count = 0;

  size_t back(size_t k) const { return (next + kMoves - 1 - k) % kMoves; }
};

// d = -H r (Nocedal, Wright 2006, algorithm 7.4).
void direction(Global& global, const Moves& moves, std::span<const double> r, std::span<double> d) {
  double alpha[kMoves];
  std::copy(r.begin(), r.end(), d.begin());
  for (size_t k = 0; k < moves.count; ++k) {
    const size_t j = moves.back(k);
    alpha[k] = moves.per_sy[j] * Descent::dot(moves.s[j], d);
    for (size_t i = 0; i < d.size(); ++i) d[i] -= alpha[k] * moves.y[j][i];
  }
  global.factors.solve_three(d, d);
  for (size_t k = moves.count; k-- > 0;) {
    const size_t j = moves.back(k);
    const double beta = alpha[k] - moves.per_sy[j] * Descent::dot(moves.y[j], d);
    for (size_t i = 0; i < d.size(); ++i) d[i] += beta * moves.s[j][i];
  }
  for (double& c : d) c = -c;
}

}  // namespace

std::optional<std::string> refuses_without_bound(const ForceField& field) {
  if (field.stiffness_bound()) return std::nullopt;
  return "projective dynamics is for forces of springs between points";
}

void step_projective_dynamics(const ForceField& field, State& state, const StepInput& in,
                              const IntegratorOptions& options) {
  Motion m(field, state, in);
  auto& global = in.workspace.object<Global>("projective_dynamics.global");
  global.prepare(field, *field.stiffness_bound(), state, in.h);
  Descent descent(m);
  const size_t n = descent.size();
  const auto array = [&](const char* key) { return m.scratch(key, n).subspan(0, n); };
  const auto x = array("projective_dynamics.x"), r = array("projective_dynamics.r"),
             d = array("projective_dynamics.d"), x1 = array("projective_dynamics.x1"),
             r1 = array("projective_dynamics.r1");
  const auto kept = m.scratch("projective_dynamics.moves", 2 * kMoves * n);
  Moves moves;
  for (size_t k = 0; k < kMoves; ++k) {
    moves.s[k] = kept.subspan(2 * k * n, n), moves.y[k] = kept.subspan((2 * k + 1) * n, n);
  }

  for (size_t k = 0; k < n; ++k) x[k] = descent.x0()[k] + in.h * descent.v0()[k];
  descent.gradient(x, r);
  const double goal = options.newton_tolerance * std::sqrt(Descent::dot(r, r));
  for (int iteration = 0; iteration < options.descent_iterations; ++iteration) {
    if (!(std::sqrt(Descent::dot(r, r)) > goal)) break;
    direction(global, moves, r, d);
    double slope = Descent::dot(d, r);
    if (!(slope < 0)) {
      moves.count = 0;
      direction(global, moves, r, d);
      slope = Descent::dot(d, r);
      if (!(slope < 0)) break;
    }
    double share = 1, after = 0;
    for (int k = 0;; ++k) {
      for (size_t i = 0; i < n; ++i) x1[i] = x[i] + share * d[i];
      descent.gradient(x1, r1);
      after = Descent::dot(d, r1);
      if (after <= -kSlopeLeft * slope || k == kMostShortenings) break;
      share *= std::clamp(-slope / (after - slope), 0.1, 0.7);
    }
    const auto &s = moves.s[moves.next], &y = moves.y[moves.next];
    for (size_t i = 0; i < n; ++i) s[i] = x1[i] - x[i], y[i] = r1[i] - r[i];
    const double sy = Descent::dot(s, y);
    // Where the potential has negative curvature, a move says nothing about it.
    if (sy > 1e-12 * std::sqrt(Descent::dot(s, s) * Descent::dot(y, y))) {
      moves.per_sy[moves.next] = 1 / sy;
      moves.next = (moves.next + 1) % kMoves;
      moves.count = std::min(moves.count + 1, kMoves);
    }
    std::copy(x1.begin(), x1.end(), x.begin());
    std::copy(r1.begin(), r1.end(), r.begin());
  }
  descent.finish(x);
  m.project();
}

}  // namespace truestep
