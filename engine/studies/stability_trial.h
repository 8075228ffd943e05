// Whether a method is stable at a step: a run from a slightly disturbed start, beside the reference motion,
// which is the scene's own method at its own step. A run that goes ten times as far as the reference in the
// same time is unstable if it also has gained the energy to do so: what only loses energy may end somewhere
// else, or go on where the reference was stopped, and is stable.
#pragma once
#include <boost/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/session/world/world.h"
#include "engine/studies/stability.h"

namespace truestep {

class StabilityTrial {
 public:
  StabilityTrial(const boost::json::value& scene, size_t system, std::string method, StudyContext& context)
      : scene_(scene), system_(system), method_(std::move(method)), context_(context) {}

  struct OverBudget {};
  struct TooLong {};  ///< scenes do not accept such a step

  /// Steps of the runs from now on, and the CPU time of this thread (s) at which they end with OverBudget.
  void set_steps(int64_t steps);
  void stop_at(double cpu) { stop_at_ = cpu; }
  int64_t steps() const { return steps_; }
  /// Runs since the steps were set.
  int runs() const { return runs_; }
  bool stable(double dt);
  /// Whether a run ended early, having gained nothing, because an implicit method did not solve its
  /// equations.
  bool unsolved() const { return unsolved_; }
  /// s that the steps of the last stable run took.
  double stepping() const { return stepping_; }

 private:
  void step(const World& world, WorldState& state, Workspace& workspace) const;
  void disturb(State& s) const;
  double reach(double dt, const std::vector<double>& start);
  void follow(const std::vector<double>& start);
  std::optional<Energy> energy(const World& world, const WorldState& state, Workspace& workspace) const;

  const boost::json::value& scene_;
  size_t system_;
  std::string method_;
  StudyContext& context_;
  std::vector<std::pair<double, double>> reaches_;  ///< s and m of the reference
  double at_work_ = 0;                              ///< J, the most that the reference moves to and fro
  double stop_at_ = 0;
  int64_t steps_ = 0;
  double stepping_ = 0;
  int runs_ = 0;
  bool unsolved_ = false;
};

}  // namespace truestep
