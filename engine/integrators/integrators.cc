// The table of methods. Stability limits are the roots of each method's stability polynomial on the
// imaginary and the negative real axis; tests find them again by bisection on a real field.
#include "engine/core/integrator.h"

#include <array>
#include <limits>

#include "engine/integrators/methods.h"

namespace truestep {

std::span<const Integrator> integrators() {
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  using Structure = Integrator::Structure;
  using Stepping = Integrator::Stepping;
  static const std::array kTable = {
      Integrator{.name = "euler",
                 .title = "explicit Euler",
                 .order = 1,
                 .imaginary_limit = 0,
                 .real_limit = 2,
                 .order_with_velocity = 1,
                 .source = "Hairer, Norsett, Wanner 1993, eq. I.7.3",
                 .step = step_euler},
      Integrator{.name = "symplectic_euler",
                 .title = "symplectic Euler (semi-implicit: velocity first)",
                 .order = 1,
                 .imaginary_limit = 2,
                 .real_limit = 2,
                 .structure = Structure::symplectic,
                 .order_with_velocity = 1,
                 .source = "Hairer, Lubich, Wanner 2006, eq. I.1.9",
                 .step = step_symplectic_euler},
      Integrator{.name = "midpoint",
                 .title = "explicit midpoint rule (Runge)",
                 .order = 2,
                 .imaginary_limit = 0,
                 .real_limit = 2,
                 .order_with_velocity = 2,
                 .source = "Hairer, Norsett, Wanner 1993, eq. II.1.4",
                 .step = step_midpoint},
      Integrator{.name = "modified_euler",
                 .title = "Euler with the mean of both ends' velocities",
                 .order = 1,
                 .imaginary_limit = 0,
                 .real_limit = 2,
                 .order_with_velocity = 1,
                 .source = "trapezoidal position update, textbook kinematics",
                 .step = step_modified_euler},
      Integrator{.name = "heun",
                 .title = "Heun's method (explicit trapezoid)",
                 .order = 2,
                 .imaginary_limit = 0,
                 .real_limit = 2,
                 .order_with_velocity = 2,
                 .source = "Heun 1900; Hairer, Norsett, Wanner 1993, table II.1.1",
                 .step = step_heun},
      Integrator{.name = "verlet",
                 .title = "Verlet's method in position form",
                 .order = 2,
                 .imaginary_limit = 2,
                 .real_limit = 1,
                 .structure = Structure::symplectic,
                 .order_with_velocity = 2,
                 .source = "Verlet 1967, eq. 4",
                 .prepare = prepare_verlet,
                 .step = step_verlet,
                 .refuses = refuses_general_rates},
      Integrator{.name = "velocity_verlet",
                 .title = "velocity Verlet (kick, drift, kick)",
                 .order = 2,
                 .imaginary_limit = 2,
                 .real_limit = 2,
                 .structure = Structure::symplectic,
                 .order_with_velocity = 2,
                 .source = "Swope, Andersen, Berens, Wilson 1982, eqs. 4 and 6",
                 .step = step_velocity_verlet},
      Integrator{.name = "leapfrog",
                 .title = "leapfrog (drift, kick, drift)",
                 .order = 2,
                 .imaginary_limit = 2,
                 .real_limit = 2,
                 .structure = Structure::symplectic,
                 .order_with_velocity = 2,
                 .source = "Hairer, Lubich, Wanner 2006, eq. I.1.17",
                 .step = step_leapfrog},
      Integrator{.name = "yoshida4",
                 .title = "Yoshida's composition of three leapfrogs",
                 .order = 4,
                 .imaginary_limit = 1.57340194743454005662957947736,
                 .real_limit = 0.893399012419685359318014750968,
                 .structure = Structure::symplectic,
                 .order_with_velocity = 3,
                 .source = "Yoshida 1990, eq. 2.13",
                 .step = step_yoshida4},
      Integrator{.name = "rk4",
                 .title = "classical Runge-Kutta",
                 .order = 4,
                 .imaginary_limit = 2.828427124746190097603377,
                 .real_limit = 2.785293563405281623529759,
                 .order_with_velocity = 4,
                 .source = "Kutta 1901; Hairer, Norsett, Wanner 1993, table II.1.2",
                 .step = step_rk4},
      Integrator{.name = "step_doubling",
                 .title = "classical Runge-Kutta with step doubling and local extrapolation",
                 .order = 5,
                 .imaginary_limit = 0,
                 .real_limit = 6.45912776782572093513853141564,
                 .stepping = Stepping::adaptive,
                 .order_with_velocity = 5,
                 .source = "Hairer, Norsett, Wanner 1993, eq. II.4.4",
                 .prepare = prepare_adaptive,
                 .step = step_step_doubling},
      Integrator{.name = "dopri5",
                 .title = "Dormand and Prince's pair of order 5 and 4",
                 .order = 5,
                 .imaginary_limit = 0.997189008632529915522534818476,
                 .real_limit = 3.306567892634946503721371,
                 .stepping = Stepping::adaptive,
                 .order_with_velocity = 5,
                 .source = "Dormand, Prince 1980, table 2; Hairer, Norsett, Wanner 1993, table II.5.2",
                 .prepare = prepare_adaptive,
                 .step = step_dopri5},
      Integrator{.name = "implicit_euler",
                 .title = "implicit Euler, Newton's method on the full equations",
                 .order = 1,
                 .imaginary_limit = kUnlimited,
                 .real_limit = kUnlimited,
                 .kind = Integrator::Kind::implicit,
                 .order_with_velocity = 1,
                 .source = "Hairer, Wanner 1996, eq. IV.3.1",
                 .step = step_implicit_euler,
                 .refuses = refuses_without_jacobian},
      Integrator{.name = "linear_implicit_euler",
                 .title = "implicit Euler with one Newton step",
                 .order = 1,
                 .imaginary_limit = kUnlimited,
                 .real_limit = kUnlimited,
                 .kind = Integrator::Kind::implicit,
                 .order_with_velocity = 1,
                 .source = "Baraff, Witkin 1998, eq. 6",
                 .step = step_linear_implicit_euler,
                 .refuses = refuses_without_jacobian},
  };
  return kTable;
}

const Integrator* find_integrator(std::string_view name) {
  for (const Integrator& m : integrators()) {
    if (m.name == name) return &m;
  }
  return nullptr;
}

std::optional<std::string> refusal(const Integrator& method, const ForceField& field) {
  if (method.order_with_velocity == 0 && field.dependence() == Dependence::position_and_velocity) {
    return "the acceleration depends on velocity, which this method cannot treat";
  }
  return method.refuses ? method.refuses(field) : std::nullopt;
}

}  // namespace truestep
