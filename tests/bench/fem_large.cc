// The linear system of an implicit step of more than 100,000 tetrahedra, M + h^2 K of a cube that is held on
// one side, by conjugate gradients with two grids beside our direct solver and beside plain conjugate
// gradients; and the whole step on one thread and two. Errors are against the direct solution, relative.
#include <cmath>

#include "engine/math/solvers/two_grid.h"
#include "engine/systems/fem/fem.h"
#include "tests/bench/implicit_matrix.h"
#include "tests/bench/report.h"

namespace {

using namespace truestep;
using namespace truestep::fem;
constexpr double kStep = 1.0 / 60, kTolerance = 1e-8;

FemDef cube(int cells, double youngs_modulus) {
  FemDef d;
  d.block = SoftBlockShape{.size = {1, 1, 1}, .cells_x = cells, .cells_y = cells, .cells_z = cells};
  d.element = Cell::tet4, d.material = Law::corotated;
  d.youngs_modulus = youngs_modulus, d.pinned = {"x0"}, d.integrator = "linear_implicit_euler";
  return d;
}

struct Run {
  Run(int cells, double youngs_modulus, int threads)
      : system(Fem::make(cube(cells, youngs_modulus),
                         BuildContext{.id = "c", .gravity = {0, -9.81, 0}, .dt = kStep})),
        state(system->initial_state()),
        arena(threads) {}
  void step() {
    system->step(state, {.t = kStep * static_cast<double>(steps),
                         .h = kStep,
                         .step = steps,
                         .workspace = workspace,
                         .arena = arena});
    ++steps;
  }
  std::unique_ptr<const Fem> system;
  State state;
  Workspace workspace;
  ThreadArena arena;
  uint64_t steps = 0;
};

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0, wrong = 0;
  for (size_t k = 0; k < a.size(); ++k)
    most = std::max(most, std::abs(b[k])), wrong = std::max(wrong, std::abs(a[k] - b[k]));
  return wrong / most;
}

void compare(int cells, double youngs_modulus) {
  Run run(cells, youngs_modulus, 1);
  const auto x = run.state.f64(FemColumns::position);
  const auto [a, b] = bench::implicit_matrix(run.system->elements(), run.state, kStep, bench::Slopes::exact,
                                             run.workspace, run.arena);
  const std::string what = std::to_string(run.system->body().mesh.cells()) + " tetrahedra of " +
                           (youngs_modulus > 1e8 ? "1e9" : "1e7") + " Pa, ";
  std::vector<double> fine(b.size()), plain(b.size()), exact(b.size());
  TwoGrid two;
  two.analyze(a);
  double start = bench::thread_seconds();
  const int iterations = two.solve(a, x, b, fine, kTolerance, 500, run.arena).iterations;
  const double grids = bench::thread_seconds() - start;
  BlockLdlt direct;
  direct.analyze(a);
  start = bench::thread_seconds();
  direct.factorize(a);
  direct.solve(b, exact);
  const double factors = bench::thread_seconds() - start;
  Pcg pcg;
  start = bench::thread_seconds();
  const int many = pcg.solve(a, b, plain, kTolerance, 20'000, run.arena).iterations;
  const double gradients = bench::thread_seconds() - start;
  bench::report({"fem_large", what + "CPU s a solution, " + std::to_string(iterations) + " iterations", grids,
                 factors, "our direct solver", bench::Comparison::Better::lower, difference(fine, exact),
                 0.0});
  bench::report({"fem_large", what + "CPU s a solution", grids, gradients,
                 "plain conjugate gradients, " + std::to_string(many) + " iterations",
                 bench::Comparison::Better::lower, difference(fine, exact), difference(plain, exact)});
}

void threads(int cells) {
  Run one(cells, 1e7, 1), two(cells, 1e7, 2);
  one.step(), two.step();
  const auto times = bench::interleaved(
      5, [&] { two.step(); }, [&] { one.step(); });
  bench::report({"fem_large",
                 std::to_string(one.system->body().mesh.cells()) + " tetrahedra, s a step, two threads",
                 times.ours,
                 times.peer,
                 "ours, one thread",
                 bench::Comparison::Better::lower,
                 {},
                 {},
                 2});
}

}  // namespace

int main() {
  compare(16, 1e7);
  compare(28, 1e7);
  compare(28, 1e9);
  threads(16);
  threads(28);
}
