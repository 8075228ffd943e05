// System "articulation": a tree of rigid links in the coordinates of its joints, stepped by any integrator.
// Rows of position and velocity are the centres of mass of all links, then their joints.
#pragma once
#include "engine/core/force_system.h"
#include "engine/integrators/default_method.h"
#include "engine/systems/articulation/articulation_field.h"

namespace truestep::articulation {

class Articulation final : public ForceSystem {
 public:
  Articulation(std::unique_ptr<const ArticulationField> field, const ChosenMethod& method,
               const ArticulationDef& def);

  void observe(const State& state, double t, Observables& out) const override;
  std::vector<FieldInfo> fields() const override;
  FieldView field(const State& state, size_t which, std::vector<double>& scratch) const override;
  void check(StateCheck& check, double t) const override;
  void apply(State& state, const Command& command) const override;
  Topology topology(const State& state) const override;
  DrawnBodies bodies(const State& state) const override;
  std::vector<JointMark> joint_marks(const State& state) const override;
  /// Open while torques act or a link is pushed.
  Energy::Exchange exchange(const State& state) const override;

 private:
  const ArticulationField& tree_;
  double point_radius_;
  std::optional<Vec3> color_;
};

}  // namespace truestep::articulation
