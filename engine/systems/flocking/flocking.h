// The system type "flocking": many members that steer by their neighbours, by one of three rules.
//   reynolds      a = separation sum (1 - r/R) d/r + alignment (mean v - v) + cohesion (mean x - x) + walls
//                 + goal + flight, bounded; v += h a with bounded speed and turn; x += h v  (Reynolds 1987)
//   vicsek        x += h v; heading = mean heading within the radius, plus noise  (Vicsek et al. 1995)
//   cucker_smale  v' = (K/N) sum (1 + r^2/sigma^2)^-beta (v_j - v), by Runge-Kutta of order 4
//                 (Cucker, Smale 2007)
// Noise is a function of seed, row and step. Members have no mass, so there is no energy. Command:
// set_parameter.
#pragma once
#include <memory>

#include "engine/core/outputs/tabled.h"
#include "engine/math/trig.h"
#include "engine/neighbours/point_grid.h"
#include "engine/systems/flocking/flocking_def.h"

namespace truestep::flocking {

struct Columns {
  static constexpr State::Column position = 0, velocity = 1, weights = 2, goal = 3;
};
/// Rows of the column of weights, which commands can set.
enum class Weight : uint8_t { separation, alignment, cohesion, goal_strength, noise, coupling };
inline constexpr size_t kWeights = 6;

/// Box, nearest images and neighbours.
struct Box {
  Sides sides;
  Vec3 low, high;
  bool plane;

  /// visit(shift): every image of a place at which points within `reach` of x may be.
  template <class Visit>
  void images(const Vec3& x, double reach, Visit&& visit) const;
  Vec3 wrapped(Vec3 x) const;
};

class Flocking final : public Tabled<Flocking, StagedSystem> {
 public:
  Flocking(const FlockingDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  std::optional<double> limit(Limit which, const State& state, double h) const override;

 private:
  void steer(State& state, const StepInput& in) const;
  void align(State& state, const StepInput& in) const;
  void approach(State& state, const StepInput& in) const;
  void chase(State& state, const StepInput& in) const;
  void remember(State& state, const StepInput& in) const;
  void touch(State& state, const StepInput& in) const;
  struct Motion;
  Motion motion(const State& state, double t) const;
  struct Groups;
  Groups groups(const State& state, double t) const;
  Vec3 avoidance(const State& state, const Vec3& x, const Vec3& heading, double t) const;
  void hold(double* x, double* v, size_t row) const;

  FlockingDef def_;
  uint64_t seed_;
  size_t boids_, rows_;
  double reach_, cos_view_;
  Box box_;
  ColliderSet colliders_;
};

template <class Visit>
void Box::images(const Vec3& x, double reach, Visit&& visit) const {
  if (sides != Sides::periodic) return visit(Vec3{});
  const Vec3 size = high - low;
  // At most one image along a direction: half the box is at least the reach.
  const auto other = [reach](double at, double low_side, double high_side, double edge) {
    return at - low_side < reach ? edge : high_side - at < reach ? -edge : 0.0;
  };
  const Vec3 s{other(x.x, low.x, high.x, size.x), other(x.y, low.y, high.y, size.y),
               plane ? 0.0 : other(x.z, low.z, high.z, size.z)};
  for (int k = 0; k < 8; ++k) {
    if ((k & 1 && s.x == 0) || (k & 2 && s.y == 0) || (k & 4 && s.z == 0)) continue;
    visit(Vec3{k & 1 ? s.x : 0, k & 2 ? s.y : 0, k & 4 ? s.z : 0});
  }
}

std::unique_ptr<const System> build_flocking(const void* def, const BuildContext& context);

}  // namespace truestep::flocking
