// The value of second copies of a method: rows of the table whose `step` on force fields is not their
// `advance` over the field's right-hand side, beside that, on two points with a spring and on a cloth of
// 9,702 springs. A copy stays if it saves 5 % on one of the two. `bench_method_paths 20 rk4` runs 20 steps of
// one method on either path, for callgrind (functions own_path and one_path), which is not disturbed by a
// busy machine.
#include <cstdlib>

#include "engine/integrators/field_equations.h"
#include "engine/integrators/table/integrators.h"
#include "engine/systems/mass_spring/mass_spring_def.h"
#include "engine/systems/mass_spring/mass_spring_field.h"
#include "tests/bench/report.h"

namespace truestep::bench {
using namespace mass_spring;
namespace {

constexpr double kStep = 1e-4;  // s

struct Run {
  const Integrator& method;
  const MassSpringField& field;
  State state = field.initial_state();
  Workspace workspace = {};
  ThreadArena arena{1};
  uint64_t step = 0;

  Run(const Integrator& m, const MassSpringField& f) : method(m), field(f) {
    if (m.prepare) m.prepare(f, state);
  }
  StepInput input() {
    const double t = static_cast<double>(step) * kStep;
    return {.t = t, .h = kStep, .step = step++, .workspace = workspace, .arena = arena};
  }
};

[[gnu::noinline]] void own_path(Run& r, int steps) {
  for (int i = 0; i < steps; ++i) r.method.step(r.field, r.state, r.input(), {});
}
[[gnu::noinline]] void one_path(Run& r, int steps) {
  for (int i = 0; i < steps; ++i)
    step_equations(r.method.advance, r.field, r.state, r.input(), {}, MethodHistory::kept);
}

void compare(const char* name, const char* what, const MassSpringField& field, int steps, int rounds) {
  const Integrator& m = *find_integrator(name);
  Run own(m, field), one(m, field);
  own_path(own, 3), one_path(one, 3);
  const Paired p = paired(
      rounds, [&] { own_path(own, steps); }, [&] { one_path(one, steps); }, thread_seconds);
  report({.bench = "method_paths." + std::string(name),
          .metric = std::string("seconds per step, ") + what,
          .ours = p.times.ours / steps,
          .peer = p.times.peer / steps,
          .peer_name = "advance over the field's right-hand side"});
}

}  // namespace
}  // namespace truestep::bench

int main(int argc, char** argv) {
  using namespace truestep;
  using namespace truestep::bench;
  const int only = argc > 1 ? std::atoi(argv[1]) : 0;
  MassSpringDef pair, cloth;
  pair.free = FreeShape{.points = {{0, 0, 0}, {1, 0, 0}}, .springs = {{.a = 0, .b = 1}}};
  cloth.cloth_grid = ClothGridShape{.nx = 50, .ny = 50};
  cloth.mass = 1e-3, cloth.stiffness = 100, cloth.shear_stiffness = 50, cloth.pins = {0, 49};
  const MassSpringField small(pair, {.id = "pair"}), large(cloth, {.id = "cloth"});
  const char* const all[] = {"euler",
                             "symplectic_euler",
                             "velocity_verlet",
                             "leapfrog",
                             "yoshida4",
                             "yoshida8",
                             "pefrl",
                             "midpoint",
                             "heun",
                             "rk4",
                             "bs32",
                             "dopri5",
                             "tsit5",
                             "dop853",
                             "ssprk104"};
  for (const char* name : all) {
    if (argc > 2 && std::string_view(argv[2]) != name) continue;
    if (argc <= 3 || std::string_view(argv[3]) == "pair")
      compare(name, "two points", small, only ? only : 2000, only ? 1 : 101);
    if (argc <= 3 || std::string_view(argv[3]) == "cloth")
      compare(name, "cloth of 9702 springs", large, only ? only : 5, only ? 1 : 101);
  }
}
