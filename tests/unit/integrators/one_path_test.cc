// An adaptive method exists once: on a force field it gives the same bits as on the field's right-hand side,
// under the same error norm.
#include <gtest/gtest.h>

#include "engine/integrators/field_equations.h"
#include "engine/integrators/table/integrators.h"
#include "engine/systems/mass_spring/mass_spring_def.h"
#include "engine/systems/mass_spring/mass_spring_field.h"

namespace truestep {
using namespace mass_spring;
namespace {

MassSpringDef chain() {
  MassSpringDef d;
  d.rope = RopeShape{.from = {0, 0, 0}, .to = {1, 0, 0}, .links = 4};
  d.pins = {0};
  return d;
}

State after(const Integrator& m, const MassSpringField& field, bool by_advance) {
  State s = field.initial_state();
  if (m.prepare) m.prepare(field, s);
  Workspace workspace;
  const ThreadArena arena(1);
  const IntegratorOptions options{.tolerance = 1e-5};
  for (uint64_t n = 0; n < 5; ++n) {
    const StepInput in{
        .t = 0.01 * static_cast<double>(n), .h = 0.01, .step = n, .workspace = workspace, .arena = arena};
    if (by_advance) {
      const bool repeats = m.name.starts_with("cvode");
      step_equations(m.advance, field, s, in, options,
                     repeats ? MethodHistory::repeated : MethodHistory::kept);
    } else {
      m.step(field, s, in, options);
    }
  }
  return s;
}

TEST(OnePath, AdaptiveMethodsDoTheSameOnFieldsAndOnTheirEquations) {
  const MassSpringDef def = chain();
  const MassSpringField field(def, {.id = "chain"});
  size_t seen = 0;
  for (const Integrator& m : integrators()) {
    if (m.stepping != Integrator::Stepping::adaptive || refusal(m, field)) continue;
    EXPECT_EQ(after(m, field, false), after(m, field, true)) << m.name;
    ++seen;
  }
  EXPECT_GE(seen, 10u);
  // Control: rk4 keeps a second path for fields, which rounds differently.
  const Integrator& rk4 = *find_integrator("rk4");
  EXPECT_NE(after(rk4, field, false), after(rk4, field, true));
}

}  // namespace
}  // namespace truestep
