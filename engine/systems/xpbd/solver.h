// One step of position-based dynamics, in substeps of h (Macklin, Storey, Lu, Terdiman, Chentanez, Jeschke,
// Mueller 2019, "Small steps in physics simulation", algorithm 1; Mueller et al. 2007, algorithm 1, for pbd):
//   v += h M^-1 f,   x_n = x,   x += h v,   every constraint moves its points,   v = (x - x_n) / h,
//   colliders.
// If the number of substeps is free, a substep is no longer than with `substeps` of them, and short enough
// that tension turns no link by more than is stable (q of kernels/xpbd/chain.h), judged by the previous
// substep. Multipliers start at zero in every substep. Carried over, they would integrate the error of a
// sweep that has not converged: a third-order loop without damping, which gains energy at once. Numbers
// inside are T, as displacements since the step's start: in floats, displacements resolve what gravity adds
// in a substep, h^2 g, and positions do not.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/collision/points/collider_set.h"
#include "engine/core/system.h"
#include "engine/kernels/xpbd/chain.h"
#include "engine/systems/xpbd/columns.h"
#include "engine/systems/xpbd/jacobi_links.h"
#include "engine/systems/xpbd/matching/match_solver.h"
#include "engine/systems/xpbd/rods/rod_solver.h"
#include "engine/systems/xpbd/schedule.h"
#include "engine/systems/xpbd/sheets/air_drag.h"
#include "engine/systems/xpbd/sheets/self_contacts.h"
#include "engine/systems/xpbd/tearing/torn_links.h"
#include "engine/systems/xpbd/tether.h"

namespace truestep::xpbd {

struct SolverOptions {
  Scheme scheme = Scheme::xpbd;
  int substeps = 1, iterations = 1;
  Sweep sweep = Sweep::chains;
  enum class Division : uint8_t { fixed, by_tension } division = Division::fixed;
  double projection = 1;
  std::optional<double> poisson_ratio;  ///< for elastic tetrahedra; absent: their volume is kept
  Membrane membrane = Membrane::links;
  double sheet_ratio = 0.3;  ///< Poisson's ratio of a membrane
  double radius = 0;         ///< m, distance kept from colliders
  double shortest_link = 1;  ///< m
  SelfOptions self;
};

/// What a solver knows of a body besides the state; all of it outlives the step.
struct SolverInput {
  const Body& body;
  const Schedule& schedule;
  const SolverOptions& options;
  const ColliderSet& colliders;
  std::span<const Surface> surfaces;
  const FoldSurface* folds;  ///< null: no self-collision
  const AirDrag* air;        ///< null: none
  const RodSet& rods;
  const TearSurface* tears;  ///< null: nothing tears
  const MatchSet& matches;
  std::span<const Tether> tethers;
};

/// Longest chain, in links, whose batch has its scratch on the stack, in the first-level cache.
inline constexpr uint32_t kShortChain = 128;
/// Least number of links, over all lanes, worth a task.
inline constexpr size_t kTaskLinks = 4096;

/// Scratch of one system: constants packed lane by lane, which follow from the state's stiffnesses and the
/// step, and values that live for one step only.
template <class T>
class Solver {
 public:
  void step(const SolverInput& what, State& state, const StepInput& in);

 private:
  template <class U>
  using Column = std::vector<U, CacheLineAllocator<U>>;
  struct Set {
    Column<T> k, rest, compliance, lambda, base;
  };

  T* lambda_of(Column<T>& lambda, size_t at) { return keeps_ ? lambda.data() + at : nullptr; }
  /// For a constraint of stiffness k.
  double compliance(double k) const { return !soft_ ? 0 : k > 0 ? 1 / k : kIdle; }
  /// Whether constants were packed for these triangle corners.
  bool same_corners(const SolverInput& what, const State& state);
  void prepare(const SolverInput& what, const State& state);
  static void resize(size_t entries, size_t points, size_t components, Set& out);
  template <class Bends, class Torn>
  void pack_bends(const SetSchedule& schedule, const Bends& bends, double stiffness, const Torn& torn,
                  Set& out) const;
  void pack_links(const SolverInput& what, const State& state);
  void load(const SolverInput& what, const State& state, const StepInput& in);
  /// State of the constraints at the step's start.
  void load_chains(const SolverInput& what, const double* x, const StepInput& in);
  template <class Bends>
  void load_bends(const SetSchedule& schedule, const Bends& bends, const double* x, Set& out) const;
  void pack_volumes(const SolverInput& what, const State& state);
  void load_volumes(const SolverInput& what, const double* x);
  void pack_sheet(const SolverInput& what, const State& state);
  void load_sheet(const SolverInput& what, const double* x);
  /// Returns the largest q.
  double solve_sheet(const SolverInput& what, const StepInput& in, double h);
  void hold_tethers(const SolverInput& what, const State& state, const StepInput& in);
  void store(const SolverInput& what, State& state, const StepInput& in) const;
  void remember_velocities(const StepInput& in);
  /// Inverse masses under viscous damping c, 1 / (m + h c): implicit Euler for -c v.
  void weigh(const State& state, const StepInput& in, double h);
  void blow(const SolverInput& what, const State& state, const StepInput& in, double t, double h);
  void predict(const SolverInput& what, const State& state, const StepInput& in, double h);
  /// Returns the largest q of the last iteration.
  double iterate(const SolverInput& what, const State& state, const StepInput& in, double h);
  /// Returns the largest q.
  double solve_chain_colours(const SolverInput& what, const StepInput& in, double h);
  template <class Solve>
  void each_batch(const SetSchedule& schedule, const StepInput& in, const Solve& solve);
  void hold_drags(const State& state, double h);
  void find_velocities(const SolverInput& what, const StepInput& in, double h);
  /// Returns the farthest (m) that a collider has moved a point back.
  double collide(const SolverInput& what, const State& state, const StepInput& in, double t, double h);
  /// Positions at the substep's start and now, and inverse masses, in double precision.
  void unpack(const SolverInput& what, const State& state, const StepInput& in);
  /// Returns the farthest (m) that self-collision has moved a point back.
  double meet_self(const SolverInput& what, const State& state, const StepInput& in, double h);

  size_t points_ = 0;  // of the state
  const Schedule* built_for_ = nullptr;
  std::vector<double> built_with_;  // stiffnesses, damping
  std::vector<uint32_t> corners_;   // of a cloth that tears
  T relax_ = 1;
  bool soft_ = true;    // xpbd: constraints have compliance
  bool keeps_ = false;  // keeps multipliers, if there is more than one iteration
  bool damped_ = false;

  Column<T> rows_, before_, velocity_;  // 4 a row: (dx, dy, dz, inverse mass), (vx, vy, vz, -)
  Column<T> rest_, compliance_, damping_, lambda_, base_;
  std::vector<T> q_, sheet_q_;  // per batch of chains, of triangles
  Set rods_, hinges_, volumes_, sheet_;
  std::vector<double> angle_lambda_;
  std::vector<uint8_t> angle_torn_;
  TornLinks<T> strands_;
  std::vector<ChainRow<T>, CacheLineAllocator<ChainRow<T>>> scratch_;
  std::vector<double> x_old_, v_old_, x_, v_, w_;  // for collisions
  std::vector<double> put_back_;                   // per block, m
  SelfContacts self_;
  std::optional<FoldSurface> torn_folds_;  // of a cloth that tears and collides with itself
  const FoldSurface& folds(const SolverInput& what) const { return torn_folds_ ? *torn_folds_ : *what.folds; }
  RodSolver cosserat_;
  MatchSolver matcher_;
  JacobiLinks<T> jacobi_;    // empty if links are solved one after another
  std::vector<Vec3> blows_;  // N s, per triangle
  AirFaces torn_faces_;      // of a cloth that tears
};

template <class T>
template <class Solve>
void Solver<T>::each_batch(const SetSchedule& schedule, const StepInput& in, const Solve& solve) {
  for (const Colour& c : schedule.colours) {
    in.arena.for_blocks(c.end - c.begin, kTaskLinks / 8, [&](size_t begin, size_t end) {
      for (size_t b = c.begin + begin; b < c.begin + end; ++b) solve(b);
    });
  }
}

extern template class Solver<float>;
extern template class Solver<double>;

}  // namespace truestep::xpbd
