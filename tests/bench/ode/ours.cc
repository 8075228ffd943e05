// A row of the method table as a solver of the benchmark.
#include <memory>
#include <stdexcept>

#include "engine/base/errors.h"
#include "engine/core/equations/integrator.h"
#include "engine/integrators/advance.h"
#include "engine/integrators/table/integrators.h"
#include "tests/bench/ode/problems.h"

namespace truestep::bench {

Solver ours(const char* name, const RightHandSide& f, const Case& at, int from, int to) {
  const Integrator* row = find_integrator(name);
  if (!row || !row->advance) throw std::logic_error(std::string("no method ") + name);
  // Scratch memory is kept from run to run, as in a session.
  const auto workspace = std::make_shared<Workspace>();
  const auto run = [row, &f, &at, workspace](double tolerance) -> Outcome {
    Outcome out{.end = at.start};
    Carry carry;
    Statistics counted;
    Advance advance{.f = f,
                    .t = 0,
                    .t_end = at.t_end,
                    .y = out.end.data(),
                    .workspace = *workspace,
                    .carry = carry,
                    .tolerance = {.relative = tolerance, .absolute = tolerance * at.absolute_scale},
                    .statistics = &counted};
    try {
      row->advance(advance);
    } catch (const Error&) {
      return {};  // so coarse that bodies collide, or finer than double precision
    }
    out.evaluations = counted.rates;
    return out;
  };
  return {.name = name, .side = "ours", .from = from, .to = to, .run = run};
}

}  // namespace truestep::bench
