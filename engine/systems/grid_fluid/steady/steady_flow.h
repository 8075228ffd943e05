// A steady flow in the plane, found directly: its stream function psi (kernels/mac/stream_function.h)
// satisfies
//   R(psi) = curl(-div(u u) + viscosity lap u + force) = 0,   u = curl psi,
// with the same differences that central advection steps in time, so that a flow stepped long enough ends
// here.
//   levels: the same box with half as many cells each way is solved first and gives the next level its start
//   Newton: J dpsi = -R with J measured from R, which is quadratic, by 13 differences (each reaches two nodes
//     along the axes and one diagonally: Curtis, Powell, Reid 1974; the 13 colours tile the plane, Golomb,
//     Welch 1970), factored as a band (math/solvers/tile_band_lu.h) and kept while it is useful; the error of
//     an old J, or of a J of second order with differences of fourth, is removed by mixing (Anderson 1965, as
//     in Walker, Ni 2011, "Anderson acceleration for fixed-point iterations")
//   from rest: 1/tau lap psi added to J, tau growing as R falls (Mulder, van Leer 1985; Kelley, Keyes 1998,
//     "Convergence analysis of pseudo-transient continuation").
// Scratch of one thread's run; psi is in the state. Not for flows that shed eddies: they also have a steady
// state, but it is unstable.
#pragma once
#include <optional>

#include "engine/kernels/mac/stream_function.h"
#include "engine/lattice/solvers/staggered_solver.h"
#include "engine/math/solvers/tile_band_lu.h"
#include "engine/systems/grid_fluid/flow.h"

namespace truestep::grid_fluid {

class SteadyFlow {
 public:
  /// Error "scene_invalid" if sides or forces depend on time, or walls of fourth order on position.
  static void check(const FlowModel& model);
  void bind(const FlowModel& model, const ThreadArena& arena);

  struct Outcome {
    bool found = false;
    int iterations = 0;  ///< on the finest grid
    double change = 0;   ///< of the velocity in the last of them, relative to the fastest
  };
  enum class From : uint8_t { rest, psi };
  /// Solves for psi (m^2/s) on the nodes of the model's grid, in place. `tolerance` bounds Outcome::change.
  Outcome solve(double* psi, double viscosity, From from, double tolerance);
  /// Velocity and pressure from psi.
  void fields(const double* psi, FlowFields& f);
  /// 1/s, largest divergence of the cells whose differences do not reach a side.
  double largest_divergence(const FlowFields& f) const;

  static constexpr size_t kMostAcross = 512;  ///< cells along the shorter axis
  /// Bytes of the finest grid's factors and arrays.
  static double bytes(const GridFluidDef& def);

 private:
  using Array = std::vector<double, CacheLineAllocator<double>>;
  struct Level {
    mac::MacGrid grid;
    std::array<mac::Sides, 2> sides;
    std::array<Array, 2> force;  ///< empty: none
    Array boundary;              ///< psi on the sides, 0 on the other nodes
  };
  void add_level(const mac::MacGrid& grid);
  /// R at the nodes, in the order of the unknowns.
  enum class Order : uint8_t { scene, second };
  void residual(const Level& l, const double* psi, Order order, double* r);
  void measure_jacobian(const Level& l, const double* psi, double per_tau);
  Outcome solve_level(const Level& l, double* psi, From from, double tolerance, int most);
  Outcome solve_from(const Level& l, double* psi, double tolerance);
  void prolong(const Level& coarse, const double* from, const Level& fine, double* to) const;
  /// Largest velocity from differences of psi (m/s).
  double fastest(const Level& l, const double* psi) const;
  void scatter(const Level& l, const double* x, double* psi) const;
  void mix(size_t round, size_t n);
  template <class F>
  void for_unknowns(const mac::MacGrid& g, F&& f) const;

  const FlowModel* model_ = nullptr;
  const ThreadArena* arena_ = nullptr;
  static double fastest_side(const Level& l);  ///< m/s, as the scene gives them
  double viscosity_ = 0;
  mac::Edges edges_;
  std::vector<Level> levels_;  ///< the finest first
  TileBandLu lu_;
  std::array<Array, 2> u_, rate_;
  Array psi_, start_, trial_, curl_;
  std::vector<double> r_, r2_, step_, last_step_, x_, last_x_;
  static constexpr size_t kMixed = 8;
  std::vector<std::vector<double>> step_changes_, x_changes_;  ///< of the last rounds
  std::optional<lattice::StaggeredSolver> pressure_;
};

}  // namespace truestep::grid_fluid
