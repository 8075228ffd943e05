#include "engine/integrators/implicit/impulse_answer.h"

#include <algorithm>

#include "engine/integrators/implicit/implicit_system.h"

namespace truestep {

void answer_implicitly(const ForceField& field, const IntegratorOptions& options, State& state,
                       const StepInput& in, AnswersImpulses::Answer which, std::span<const double> impulses,
                       std::span<double> dv) {
  Motion m(field, state, in);
  if (m.v.empty()) return;
  ImplicitSystem system(m);
  const auto w = system.inverse_mass();
  const auto b = m.scratch("integrator.rhs", m.v.size());
  m.loop(w.size(), [&](size_t i) {
    Vec3 impulse = w[i] > 0 ? load3(impulses.data(), i) : Vec3{};
    if (system.contacts()) impulse = system.contacts()->left(i, impulse);
    store3(b.data(), i, impulse);
  });
  const double accuracy = std::clamp(options.newton_tolerance, 1e-14, 1e-2);
  if (which == AnswersImpulses::Answer::again) return system.solve_again(b, dv, accuracy);
  system.differentiate(in.t + in.h, m.x, m.v, Derivatives::definite);
  system.assemble(in.h, in.h);
  system.constrain();
  system.solve(b, dv, accuracy);
}

}  // namespace truestep
