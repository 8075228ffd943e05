// Verlet's method in its position form (Verlet 1967, "Computer experiments on classical fluids", eq. 4):
//   x_{n+1} = 2 x_n - x_{n-1} + h^2 a_n,        v_{n+1} = (3 x_{n+1} - 4 x_n + x_{n-1}) / (2 h).
// The velocity is the second-order difference at the step's end, since the state must hold both at the same
// time (Verlet's own v_n = (x_{n+1} - x_{n-1}) / (2 h) is known one step late). A velocity-dependent
// acceleration is also evaluated at it, which keeps order 2. The state carries x_{n-1} and the (x, v, h) left
// by this method: elements whose position or velocity has been changed since (a command, a collision), new
// elements, and all of them when h changes, restart with x_{n-1} = x_n - h v_n + h^2 a_n / 2.
#include "engine/integrators/motion.h"
#include "engine/integrators/table/methods.h"

#include <algorithm>
#include <limits>

namespace truestep {

namespace {
constexpr std::string_view kPrevious = "integrator.previous_position";
constexpr std::string_view kLeftPosition = "integrator.left_position";
constexpr std::string_view kLeftVelocity = "integrator.left_velocity";
constexpr std::string_view kLeftStep = "integrator.left_step";

// The column, as long as the position; new rows are NaN, which equals nothing and so forces a restart.
double* carried(State& s, std::string_view name, size_t rows) {
  const auto c = s.at(name);
  const size_t old = s.rows(c);
  if (old != rows) {
    s.resize(c, rows);
    const auto all = s.f64(c);
    std::fill(all.begin() + static_cast<std::ptrdiff_t>(std::min(old, rows) * s.info(c).width), all.end(),
              std::numeric_limits<double>::quiet_NaN());
  }
  return s.f64(c).data();
}
}  // namespace

std::optional<std::string> refuses_general_rates(const ForceField& field) {
  State state = field.initial_state();
  Workspace workspace;
  const ThreadArena serial(1);
  const StepInput in{.workspace = workspace, .arena = serial};
  if (Motion(field, state, in).plain_rate()) return std::nullopt;
  return "positions are not integrals of velocities here (orientations): use velocity_verlet";
}

void prepare_verlet(const ForceField&, State& s) {
  const ColumnInfo x = s.info(s.at("position")), v = s.info(s.at("velocity"));
  s.add({std::string(kPrevious), x.unit, Scalar::f64, x.width, Role::sentinel}, 0);
  s.add({std::string(kLeftPosition), x.unit, Scalar::f64, x.width, Role::sentinel}, 0);
  s.add({std::string(kLeftVelocity), v.unit, Scalar::f64, v.width, Role::sentinel}, 0);
  s.add({std::string(kLeftStep), "s", Scalar::f64, 1, Role::sentinel}, 1);
}

void step_verlet(const ForceField& field, State& state, const StepInput& in, const IntegratorOptions&) {
  const size_t rows = state.rows(state.at("position"));
  double* previous = carried(state, kPrevious, rows);
  double* left_x = carried(state, kLeftPosition, rows);
  double* left_v = carried(state, kLeftVelocity, rows);
  double& left_h = state.f64(state.at(kLeftStep))[0];

  Motion m(field, state, in);
  const auto a = m.scratch("integrator.k1", m.v.size());
  m.acceleration(in.t, m.x, m.v, a);
  const double h = in.h, hh = h * h, per_2h = 0.5 / h;
  // A different step length: no stored element counts.
  const double same_h = left_h == h ? 0 : std::numeric_limits<double>::quiet_NaN();
  double *x = m.x.data(), *v = m.v.data();
  const double* pa = a.data();
  m.loop(m.v.size(), [=](size_t i) {
    const double force = hh * pa[i];
    const double anew = x[i] - h * v[i] + 0.5 * force;
    const bool untouched = (x[i] - left_x[i] == same_h) & (v[i] - left_v[i] == same_h);
    const double before = untouched ? previous[i] : anew;
    const double next = 2 * x[i] - before + force;
    const double velocity = (3 * next - 4 * x[i] + before) * per_2h;
    previous[i] = x[i];
    x[i] = left_x[i] = next;
    v[i] = left_v[i] = velocity;
  });
  left_h = h;
  m.project();
}

}  // namespace truestep
