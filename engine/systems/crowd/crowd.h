// The system type "crowd": pedestrians as discs in the plane z = 0 that head for their goals around walls.
//   social_force  m v' = m (v0 e - v)/tau + sum f_ij + sum f_iW  (Helbing, Farkas, Vicsek 2000): the driving
//                 force exactly, v <- w + (v - w) exp(-h/tau), w = v0 e + tau F/m, then x <- x + h v; in as
//                 many substeps as the contacts need
//   orca          v = closest to the desired velocity in the half-planes of neighbours and walls (van den
//                 Berg, Guy, Lin, Manocha 2011), x <- x + h v; nobody takes more than half of a gap in a step
// e comes from navigation.h. Those who arrive may leave: their row is removed. Commands: impulse
// (social_force), set_parameter speed_factor.
#pragma once
#include <memory>
#include <optional>

#include "engine/core/outputs/tabled.h"
#include "engine/kernels/crowd/social_force.h"
#include "engine/neighbours/point_grid.h"
#include "engine/systems/crowd/navigation.h"

namespace truestep::crowd {

struct Columns {
  /// One row per person still present.
  static constexpr State::Column position = 0, velocity = 1, goal = 2, radius = 3, mass = 4, wanted_speed = 5,
                                 person = 6, group = 7;
  /// Per door: crossings forward and backward, times of the first and the last forward (s; -1: none yet).
  static constexpr State::Column doors = 8;
  /// How many have left; a factor on all desired speeds.
  static constexpr State::Column tally = 9;
};

class Crowd final : public Tabled<Crowd, StagedSystem> {
 public:
  Crowd(const CrowdDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  std::optional<double> limit(Limit which, const State& state, double h) const override;
  void check(StateCheck& check, double t) const override;

  /// Desired velocity of row i of the state, m/s, without noise.
  Vec3 wish(const State& state, size_t i) const;

 private:
  struct Sorted;
  struct Load;
  struct Whole;
  struct Passages;
  Whole whole(const State& state, double t) const;
  Passages passages(const State& state, double t, size_t door) const;
  std::vector<std::string> doors() const;
  /// Where in the rows of all people those of a group are.
  static ShownRows rows_of(const State& state, size_t group);
  /// N/m, radial forces over the circumference of the people in these rows.
  void fill_pressure(const State& state, ShownRows rows, double* out) const;
  void set_out(State& state, const StepInput& in) const;
  void push_and_press(State& state, const StepInput& in) const;
  void choose(State& state, const StepInput& in) const;
  void arrive(State& state, const StepInput& in) const;

  /// Force on the person in a slot, and its stiffness.
  Load load(const Sorted& sorted, const State& state, size_t slot) const;
  /// Moves a row by h v, but not through walls, and around a periodic corridor.
  void move(State& state, size_t i, const Vec3& v, double h) const;
  /// visit(shift): every image of x at which people within `reach` of it may be.
  template <class Visit>
  void images(const Vec3& x, double reach, Visit&& visit) const {
    visit(Vec3{});
    if (!(def_.period > 0)) return;
    if (x.x < reach - 0.5 * def_.period) visit(Vec3{def_.period, 0, 0});
    if (x.x > 0.5 * def_.period - reach) visit(Vec3{-def_.period, 0, 0});
  }
  const Navigation* way_of(size_t group) const { return ways_[group].get(); }
  bool at_goal(const State& state, size_t i) const;
  void place(State& state, size_t group, size_t first) const;
  double lane_order(const State& state) const;
  void check_ways() const;

  CrowdDef def_;
  std::string id_;
  uint64_t seed_;
  size_t people_;
  double largest_radius_, reach_;
  SocialLaw law_;
  Walls walls_;
  std::optional<WayGrid> grid_;
  std::vector<std::shared_ptr<const Navigation>> ways_;  ///< per group; null: a fixed heading or individual
                                                         ///< goals
};

std::unique_ptr<const System> build_crowd(const void* def, const BuildContext& context);

}  // namespace truestep::crowd
