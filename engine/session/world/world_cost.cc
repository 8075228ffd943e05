// Expected cost of a world's step, once its systems are built.
#include "engine/core/equations/integrator.h"
#include "engine/integrators/control/step_work.h"
#include "engine/integrators/field_equations.h"
#include "engine/integrators/motion.h"
#include "engine/scene/admission.h"
#include "engine/session/world/world.h"

namespace truestep {

namespace {

// For an implicit method that factorises the field's derivatives.
std::optional<double> force_step_seconds(const Integration& s, const State& state, double h) {
  if (s.method->kind != Integrator::Kind::implicit || !s.method->advance) return std::nullopt;
  static const ThreadArena kSerial(1);
  Workspace workspace;
  State copy = state;
  const StepInput in{0, h, 0, workspace, kSerial};
  Motion motion(*s.field, copy, in);
  const FieldEquations f(motion);
  std::vector<double> y(motion.x.begin(), motion.x.end());
  y.insert(y.end(), motion.v.begin(), motion.v.end());
  // About 20 operations per unknown of a point, as in a cloth.
  constexpr double kPerUnknown = 20;
  const double rate = kPerUnknown * static_cast<double>(y.size());
  const auto work = implicit_step_work(*s.method, f, rate, h, y.data(), tolerance_of(*s.options));
  return work ? std::optional(work->seconds()) : std::nullopt;
}

}  // namespace

Cost World::cost(const WorldState& state) const {
  Cost sum = estimate(scene_);
  std::vector<Cost> own;
  const double h = scene_.substep(), substeps = static_cast<double>(scene_.substeps());
  for (size_t i = 0; i < size(); ++i) {
    const SceneSystem& s = scene_.systems[i];
    own.push_back(s.row->cost(s.def.get()));
    const Integration method = systems_[i]->integration();
    auto seconds = method.field ? force_step_seconds(method, state.systems[i], h) : std::nullopt;
    if (!seconds) seconds = systems_[i]->limit(Limit::step_seconds, state.systems[i], h);
    if (seconds) sum.seconds_per_step += substeps * (*seconds - own.back().seconds_per_step);
  }
  for (size_t k = 0; k < couplings_.size(); ++k) {
    const SceneCoupling& c = scene_.couplings[k];
    const ConstCoupledStates sides{state.couplings[k], state.systems[c.a], state.systems[c.b]};
    const auto seconds = couplings_[k]->step_seconds(sides, h);
    if (!seconds) continue;
    sum.seconds_per_step +=
        substeps * (*seconds - c.row->cost(c.def.get(), own[c.a], own[c.b]).seconds_per_step);
  }
  return sum;
}

}  // namespace truestep
