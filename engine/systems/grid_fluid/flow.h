// One substep of an incompressible flow on a staggered grid:
//   u_t + div(u u) = -grad p + viscosity lap u + f,   div u = 0,
// p the pressure over density. Central advection: stages of Spalart, Moser, Rogers (1991, "Spectral methods
// for the Navier-Stokes equations with one infinite and two periodic directions", appendix; weights gamma,
// zeta for convection, alpha for Crank-Nicolson viscosity), or Adams-Bashforth with Crank-Nicolson; each
// starts from the last pressure's gradient and is projected (van Kan 1986, "A second-order accurate
// pressure-correction scheme"). Advection along paths: advect, force, viscosity by backward Euler, project
// (Stam 1999, "Stable fluids"). Obstacles cut cells: the flow through a face is that of its open fraction,
// plus the obstacle's own motion (Ng, Min, Gibou 2009). With central advection and explicit viscosity
// obstacles have walls of second order (solids.h); otherwise the volume around a face takes on their velocity
// in proportion to its solid fraction. A scalar: flow_scalar.cc. Two fluids: flow_two_fluids.cc. Scratch of
// one thread's run; everything that lasts is in the state.
#pragma once
#include <memory>
#include <optional>

#include "engine/core/system.h"
#include "engine/kernels/mac/momentum.h"
#include "engine/lattice/solvers/cut_poisson.h"
#include "engine/lattice/solvers/staggered_solver.h"
#include "engine/systems/grid_fluid/flow_texts.h"
#include "engine/systems/grid_fluid/moving_solids.h"
#include "engine/systems/grid_fluid/solids.h"

namespace truestep::grid_fluid {

/// Known when the system is built, and constant.
struct FlowModel {
  FlowModel(const GridFluidDef& def, const Vec3& gravity);
  GridFluidDef def;
  mac::MacGrid grid;
  FlowTexts texts;
  Solids solids;      ///< at the start
  Vec3 gravity;       ///< m/s^2
  bool open = false;  ///< a side is an outflow
  std::array<std::array<SideKind, 2>, 3> kinds{};
  /// Whether obstacles have walls of second order.
  bool sharp_walls() const;
  /// Whether the largest divergence is recorded at the end of a step because a single state does not show it.
  bool keeps_divergence() const { return texts.obstacles_move || fourth_order(); }
  bool two_fluids() const { return def.second_fluid.has_value(); }
  bool two_viscosities() const { return two_fluids() && def.second_fluid->viscosity; }
  /// kg/m^3, of a cell of which the second fluid fills the fraction `share`.
  double density_of(double share) const;
  /// kg/m^3, of such a cell for accelerations along an axis; `normal`: square of the component along it of
  /// the border's unit normal. Positive.
  double inertia_of(double share, double normal) const;
  /// m/s^2, along axis a if the sides support the fluids against gravity; 0 along a periodic axis.
  double held_gravity(size_t a) const;
  /// Initial fractions of the second fluid.
  void fill_second(double* share) const;
  /// 1/s, rate of the shortest gravity waves on the border between two fluids; 0: there are none.
  double border_rate() const;
  bool fourth_order() const { return def.order == GridFluidDef::Order::fourth; }
  /// How values at a place are mirrored at the sides; kCentre + 1 is the pressure.
  std::array<std::array<mac::Mirror, 2>, 3> mirrors(size_t place) const;
  /// Faces [first, last) of component c along axis a that are unknowns of the equations.
  std::array<size_t, 2> unknown(size_t c, size_t a) const;
};
inline constexpr size_t kPressure = mac::kCentre + 1;

/// The arrays of a state that the flow changes.
struct FlowFields {
  mac::Fields u{}, rate{};  ///< rate: of the previous step, for two-step methods
  double *pressure = nullptr, *scalar = nullptr;
  double* second = nullptr;  ///< share of the second fluid in a cell, half a substep behind
  double border_h = 0;       ///< s, of the substep before, for the border of two fluids; 0: none
  double viscosity = 0;
  std::array<double, 3> impulse{};  ///< N s over density, given to obstacles by the fluid
  double turning = 0;               ///< N m s over density, angular, about their axes
  lattice::CutPoisson::Outcome solved;
  double last_h = 0;  ///< s, length of the substep that `rate` is from; 0: none
};

class Flow {
 public:
  void bind(const FlowModel& model, const ThreadArena& arena);

  /// Cells per second crossed by the fastest velocity, summed over the axes, including sides.
  double crossing_rate(FlowFields& f, double t);
  /// Whether viscosity is stepped implicitly in a substep of h.
  bool implicit(double viscosity, double h) const;
  void substep(FlowFields& f, double t, double h);
  /// Makes the velocity divergence-free; p += potential / h unless h is 0. Sets faces on sides for time t.
  void project(FlowFields& f, double t, double h);
  void fill(FlowFields& f, double t);
  /// share = that of the second fluid at the end of the last substep, at time t.
  void bring_up(FlowFields& f, double t, double* share);
  /// Sets the densities of two fluids from where they are now; call before `project`.
  void weigh(FlowFields& f);
  /// 1/s, largest divergence of a cell at time t, with obstacles placed for t.
  double largest_divergence(FlowFields& f, double t);

 private:
  struct Buffer {
    std::vector<double, CacheLineAllocator<double>> data;
  };
  struct Weights {
    double gamma, zeta, alpha;
  };
  void sides_at(double t);
  void fill_component(size_t c, double* u);
  /// Solves (1 - amount lap) x = change (m^2) in place for component c, walls included.
  void diffuse(size_t c, double amount, double* change);
  void stage(FlowFields& f, double t, double h, const Weights& w, bool implicit);
  void along_paths(FlowFields& f, double t, double h);
  void advect(size_t place, const mac::Sides& sides, const mac::ConstFields& u, double h, const double* from,
              double* to);
  /// The axes in turn, or the last one first.
  enum class Axes : uint8_t { forwards, backwards };
  /// Carries the scalar for h by the velocity at time t.
  void carry(FlowFields& f, double t, double h, Axes order);
  /// m/s through whole faces, free of divergence as far as the pressure solver goes.
  mac::ConstFields scalar_flow(FlowFields& f, double t);
  void add_force(FlowFields& f, double t, size_t c, double factor, double* to);
  void confine(FlowFields& f, double h);
  /// to += factor times the effect of two fluids' weight on faces of component c, not including p - density
  /// gravity . x.
  void add_weight(size_t c, double factor, double* to);
  /// Carries the border of two fluids by the velocity at time t from the middle of the substep before to that
  /// of this one, and notes what that does to the velocity.
  void carry_second(FlowFields& f, double t, double h);
  enum class Carried : uint8_t { volume, momentum };
  void carry_border(FlowFields& f, double t, double h, double* share, Carried carried);
  /// Faces within two cells of the border, where it is or also where it was before.
  enum class Since : uint8_t { now, before };
  void note_border(const FlowFields& f, Since since);
  /// Beside the border: replaces the rate (m/s^2, of component c), or the velocity after h, by what the
  /// fluxes of mass give.
  void convect_at_border(size_t c, double* rate);
  void convect_at_border(const FlowFields& f, size_t c, double h, double* moved);
  template <class F>
  void for_border_faces(size_t c, F&& set);
  /// rate += the viscous acceleration of two fluids (viscosity in m^2/s, of the first), explicitly.
  void add_viscosity(const FlowFields& f, size_t c, double viscosity, double* rate);
  void find_fluidity(const FlowFields& f);
  /// to -= factor grad p by the density of `density` on the faces of component c that the equations decide.
  void subtract_pressure(const FlowFields& f, size_t c, const double* p, double factor, double* to);
  // Obstacles (flow_solids.cc).
  /// Places obstacles for time t (s).
  void place_obstacles(double t);
  /// The same within a step, starting from the step's start.
  void move_obstacles(FlowFields& f, double t);
  /// Fluid inside obstacles takes on their velocity.
  void stop_in_solids(FlowFields& f);
  /// Sets faces inside obstacles from the parabola through the wall, at their centres or as the mean over
  /// their open part.
  enum class At : uint8_t { centre, open_part };
  void extend_into_solids(FlowFields& f, At where);
  /// Keeps faces inside obstacles unchanged; the change they would have had goes to the obstacles as impulse.
  void hold_solids(FlowFields& f, size_t c, double* change);
  /// m/s through whole faces, with the obstacles' own motion; until arrays 6 to 8 are used again.
  mac::ConstFields flow_between_solids(const FlowFields& f);
  /// phi = div(flow through the faces).
  void divergence_between_solids(const FlowFields& f, double* phi);
  /// Closed faces move with their obstacles, which receive the impulse of the pressure there.
  void settle_shut_faces(FlowFields& f, size_t c, const double* phi);
  /// Pressure in closed cells: the mean of their neighbours, a good start for when they open.
  void extend_pressure(FlowFields& f);
  /// Counts `amount` (m/s of the face's volume), given to its obstacle along component c, as torque.
  void note_turning(FlowFields& f, const Solids::Face& face, size_t c, double amount) const;
  /// f(offset of face 0 of a line along axis a, row of lines) for all such lines between the sides, rows in
  /// parallel.
  template <class F>
  void for_side(size_t a, F&& f) const;
  void open_sides(size_t c, double* u);
  void balance(FlowFields& f);
  double* array(size_t k) { return arrays_[k].data.data(); }

  const FlowModel* model_ = nullptr;
  const ThreadArena* arena_ = nullptr;
  std::array<mac::Sides, 3> sides_;
  mac::Sides scalar_sides_, pressure_sides_;
  double sides_time_ = -1, side_rate_ = 0;
  std::array<std::optional<lattice::StaggeredSolver>, 3> viscous_;
  std::optional<lattice::StaggeredSolver> pressure_, scalar_;
  std::optional<lattice::CutPoisson> cut_pressure_;
  std::array<Buffer, 10> arrays_;
  std::array<Buffer, 3> lightness_;  ///< of two fluids: `density` by the inertia of a face
  std::array<Buffer, 3> lift_;       ///< m/s^2, by their border on a face
  Buffer fluidity_;                  ///< 1/(Pa s), of cells where each fluid has its viscosity
  std::array<Buffer, 3> carried_;    ///< m/s^2, convection with the fluxes of mass
  std::array<std::vector<uint8_t>, 3> beside_border_;
  std::array<std::vector<double>, 3> force_;  ///< m/s^2, from the scene; kept if constant in time
  std::vector<double> source_;                ///< 1/s, of the scalar, likewise
  std::vector<double> row_sums_;              ///< of the velocity through a side
  MovingSolids solids_;
  std::array<std::vector<Solids::Face>, 3> were_inside_;
};

}  // namespace truestep::grid_fluid
