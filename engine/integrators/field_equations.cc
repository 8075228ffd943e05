#include "engine/integrators/field_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/byte_hash.h"
#include "engine/base/errors.h"
#include "engine/base/interrupt.h"
#include "engine/core/equations/linear_solver.h"
#include "engine/integrators/implicit/implicit.h"
#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/implicit/newton/stage_newton.h"

namespace truestep {

void FieldEquations::rate(double t, const double* y, double* dydt) const {
  interruption_point();
  const size_t nx = motion_.x.size(), nv = motion_.v.size();
  const std::span<const double> x{y, nx}, v{y + nx, nv};
  const auto moved = motion_.rate(t, x, v, {dydt, nx});
  if (moved.data() != dydt) std::copy(moved.begin(), moved.end(), dydt);
  motion_.acceleration(t, x, v, {dydt + nx, nv});
}

void FieldEquations::project(double* y) const {
  const size_t nx = motion_.x.size(), nv = motion_.v.size();
  motion_.field.project({y, nx}, {y + nx, nv}, motion_.state);
}

void FieldEquations::acceleration(double t, const double* x, const double* v, double* a) const {
  const size_t n = motion_.v.size();
  // A field that does not depend on velocity is still given one.
  motion_.acceleration(t, {x, n}, {v ? v : motion_.v.data(), n}, {a, n});
}

FieldJacobian& FieldEquations::bound_jacobian() const {
  auto& j = motion_.input.workspace.object<FieldJacobian>("integrator.field_jacobian");
  j.bind(motion_);
  return j;
}
MatrixShape FieldEquations::shape() const {
  return has_jacobian() ? bound_jacobian().shape() : MatrixShape{};
}
std::span<const double> FieldEquations::symmetric_in() const {
  if (!has_jacobian() || !motion_.field.symmetric_jacobian()) return {};
  const auto w = motion_.field.inverse_mass(motion_.state);
  return 3 * w.size() == motion_.v.size() ? w : std::span<const double>{};
}
void FieldEquations::jacobian(double t, const double* x, const double* v, double* dadx, double* dadv) const {
  bound_jacobian().evaluate(motion_, t, x, v, dadx, dadv);
}

namespace {
struct OwnSolver {
  const ForceField* field = nullptr;
  std::unique_ptr<FieldLinearSolver> solver;
};
}  // namespace

LinearSolver* FieldEquations::linear_solver() const {
  auto& own = motion_.input.workspace.object<OwnSolver>("integrator.own_solver");
  if (own.field != &motion_.field) own = {&motion_.field, motion_.field.linear_solver()};
  return own.solver.get();
}
void FieldEquations::linearise(double t, const double* y) const {
  const size_t nx = motion_.x.size(), nv = motion_.v.size();
  Evaluation e{motion_.input.workspace, motion_.input.arena};
  const auto& own = motion_.input.workspace.object<OwnSolver>("integrator.own_solver");
  own.solver->linearise({t, {y, nx}, {y + nx, nv}, motion_.state}, e);
}

bool FieldEquations::solve_stage(const Stage& stage, double* u) const {
  if (!has_jacobian() || motion_.input.workspace.object<bool>(kPointsAreMoved)) return false;
  const size_t n = motion_.v.size();
  const StageEquation eq{.t = stage.t, .g = stage.g, .s = stage.s, .x0 = {stage.x0, n}, .u0 = {stage.u0, n}};
  std::ranges::copy(eq.u0, u);
  IntegratorOptions options;
  options.newton_tolerance = stage.tolerance;
  try {
    // With damping held at x0 it would be the solution of other equations.
    return !StageNewton(motion_, options).solve(eq, {u, n}).held;
  } catch (const Instability&) {
    return false;
  }
}
void FieldEquations::reserve_stage() const {
  bool& reserved = motion_.input.workspace.object<bool>("integrator.stage_reserved");
  if (reserved || !has_jacobian()) return;
  StageNewton(motion_, {});
  reserved = true;
}

void add_memory(State& state, size_t n) {
  const auto column = state.add({"integrator.memory", "1", Scalar::f64, 1, Role::sentinel}, n);
  const auto memory = state.f64(column);
  std::fill(memory.begin(), memory.end(), std::numeric_limits<double>::quiet_NaN());
}

namespace {
constexpr std::string_view kInternalStep = "integrator.internal_step";
constexpr std::string_view kLastError = "integrator.last_error";

// A hash of the time and of all columns except those that an integration itself changes.
uint64_t surroundings_of(const State& state) {
  uint64_t hash = 0;
  for (State::Column c = 0; c < state.columns(); ++c) {
    const std::string& name = state.info(c).name;
    if (name == "position" || name == "velocity" || name == "time" || name.starts_with("integrator."))
      continue;
    hash = byte_hash(state.bytes(c).data(), state.bytes(c).size(), hash);
  }
  return hash;
}
}  // namespace

void prepare_adaptive(const ForceField&, State& s) {
  s.add({std::string(kInternalStep), "s", Scalar::f64, 1, Role::internal}, 1);
  s.add({std::string(kLastError), "1", Scalar::f64, 1, Role::internal}, 1);
}

void step_equations(AdvanceFunction* method, const ForceField& field, State& state, const StepInput& in,
                    const IntegratorOptions& options, MethodHistory history) {
  Motion m(field, state, in);
  const FieldEquations f(m);
  const size_t nx = m.x.size(), nv = m.v.size();
  const auto y = m.scratch("integrator.y", nx + nv);
  std::copy(m.x.begin(), m.x.end(), y.begin());
  std::copy(m.v.begin(), m.v.end(), y.begin() + static_cast<std::ptrdiff_t>(nx));
  const auto step = state.find(kInternalStep), error = state.find(kLastError);
  Carry carry;
  if (step) carry.step = state.f64(*step)[0];
  if (error) carry.last_error = state.f64(*error)[0];
  if (!(carry.step > 0)) carry.step = in.h;
  // The next step begins exactly where this one ends: step lengths rounded one by one would lose time.
  const double counted = static_cast<double>(in.step + 1) * in.h, summed = in.t + in.h;
  Advance advance{.f = f,
                  .t = in.t,
                  .t_end = std::abs(counted - summed) < 1e-9 * in.h ? counted : summed,
                  .y = y.data(),
                  .workspace = in.workspace,
                  .carry = carry,
                  .arena = &in.arena,
                  .tolerance = tolerance_of(options),
                  .max_steps = static_cast<uint64_t>(options.max_internal_steps),
                  .damping = options.damping,
                  .newton_tolerance = options.newton_tolerance};
  auto& watch = in.workspace.object<FieldWatch>(kFieldWatch);
  advance.watcher = watch.watcher;
  if (const auto memory = state.find("integrator.memory")) advance.memory = state.f64(*memory);
  if (history == MethodHistory::repeated) advance.surroundings = surroundings_of(state);
  advance.project = [](const RightHandSide& equations, double* at) {
    static_cast<const FieldEquations&>(equations).project(at);
  };
  try {
    method(advance);
  } catch (const Instability& e) {
    // The component's own column and row.
    if (e.index < 0) throw;
    const auto i = static_cast<size_t>(e.index);
    const bool moving = i >= nx;
    const char* name = moving ? "velocity" : "position";
    throw Instability(
        "", name, static_cast<long long>((moving ? i - nx : i) / state.info(state.at(name)).width), e.what());
  }
  watch.reached = advance.reached;
  std::copy_n(y.begin(), nx, m.x.begin());
  std::copy_n(y.begin() + static_cast<std::ptrdiff_t>(nx), nv, m.v.begin());
  if (advance.memory.empty()) m.project();
  if (step) state.f64(*step)[0] = std::min(carry.step, in.h);
  if (error) state.f64(*error)[0] = carry.last_error;
}

}  // namespace truestep
