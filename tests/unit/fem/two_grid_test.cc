// Conjugate gradients with two grids: the solution of the direct solver, few iterations however fine the
// mesh, the same bits on any number of threads, and held nodes stay out of the coarse grid.
#include "engine/math/solvers/two_grid.h"

#include <gtest/gtest.h>

#include "tests/unit/fem/fem_rig.h"

namespace truestep {
namespace {

struct System {
  BlockSparse a;
  std::vector<double> places, b;
};

/// M + h^2 K of a clamped block of tetrahedra, held nodes as rows of the identity.
System implicit_step(int cells, double youngs_modulus) {
  using namespace fem;
  FemDef d;
  d.block = SoftBlockShape{.size = {1, 1, 1}, .cells_x = cells, .cells_y = cells, .cells_z = cells};
  d.element = Cell::tet4, d.material = Law::corotated, d.youngs_modulus = youngs_modulus, d.pinned = {"x0"};
  const testing_rig::FemRun run(d);
  const FemField& field = run.system->elements();
  static const ThreadArena kSerial(1);
  Workspace workspace;
  Evaluation e{workspace, kSerial};
  const auto x = run.state.f64(FemColumns::position), v = run.state.f64(FemColumns::velocity),
             w = run.state.f64(FemColumns::inverse_mass);
  System out;
  BlockSparse dfdv;
  field.jacobian_pattern(run.state, out.a, dfdv);
  field.jacobian({0, x, v, run.state}, out.a, dfdv, e);
  constexpr double kStep = 1.0 / 60;
  for (size_t i = 0; i < w.size(); ++i) {
    for (auto s = out.a.row_begin(i); s < out.a.row_begin(i + 1); ++s) {
      const bool held = !(w[i] > 0) || !(w[out.a.column(s)] > 0);
      for (double& value : out.a.block(s)) value = held ? 0 : -kStep * kStep * value;
    }
    const auto diagonal = out.a.block(out.a.diagonal_slot(i));
    for (size_t c = 0; c < 3; ++c) diagonal[4 * c] += w[i] > 0 ? 1 / w[i] : 1;
    out.b.insert(out.b.end(), {0.0, w[i] > 0 ? -1 / w[i] : 0.0, 1e-3 * static_cast<double>(i % 7)});
  }
  out.places.assign(x.begin(), x.end());
  return out;
}

TEST(TwoGrid, SolvesAsTheDirectSolver) {
  const System s = implicit_step(8, 1e7);
  const ThreadArena arena(1);
  std::vector<double> x(s.b.size()), exact(s.b.size());
  TwoGrid two;
  const Pcg::Result r = two.solve(s.a, s.places, s.b, x, 1e-12, 200, arena);
  ASSERT_EQ(r.outcome, Pcg::Outcome::converged);
  BlockLdlt direct;
  direct.analyze(s.a);
  ASSERT_EQ(direct.factorize(s.a), BlockLdlt::Outcome::positive_definite);
  direct.solve(s.b, exact);
  double most = 0, wrong = 0;
  for (size_t k = 0; k < x.size(); ++k)
    most = std::max(most, std::abs(exact[k])), wrong = std::max(wrong, std::abs(x[k] - exact[k]));
  // The tolerance applies to the preconditioned residual: the error is as small up to that system's
  // condition.
  EXPECT_LT(wrong, 1e-10 * most);
  // Without the coarse grid the slow bending modes take many times as long.
  Pcg plain;
  EXPECT_GT(plain.solve(s.a, s.b, x, 1e-12, 10'000, arena).iterations, 4 * r.iterations);
}

TEST(TwoGrid, FinerMeshesTakeAboutAsManyIterations) {
  std::vector<int> counts;
  for (const int cells : {6, 12, 18}) {
    const System s = implicit_step(cells, 1e8);
    std::vector<double> x(s.b.size());
    TwoGrid two;
    const Pcg::Result r = two.solve(s.a, s.places, s.b, x, 1e-8, 200, ThreadArena(1));
    ASSERT_EQ(r.outcome, Pcg::Outcome::converged);
    counts.push_back(r.iterations);
  }
  // With aggregates of constant size, the ratio of the grids and with it the condition stays the same. The
  // count of plain conjugate gradients would triple.
  EXPECT_LT(counts[2], 1.6 * counts[0]) << counts[0] << ' ' << counts[1] << ' ' << counts[2];
}

TEST(TwoGrid, AnyNumberOfThreadsGivesTheSameBits) {
  const System s = implicit_step(12, 1e6);
  std::vector<double> one(s.b.size()), three(s.b.size());
  TwoGrid a, b;
  a.solve(s.a, s.places, s.b, one, 1e-8, 200, ThreadArena(1));
  b.solve(s.a, s.places, s.b, three, 1e-8, 200, ThreadArena(3));
  EXPECT_EQ(one, three);
}

}  // namespace
}  // namespace truestep
