// System "articulation": a tree of rigid links in joint coordinates, stepped by any integrator. Rows of
// position and velocity are the centres of mass of all links, then their joints.
#pragma once
#include <mutex>

#include "engine/core/equations/force_system.h"
#include "engine/core/outputs/tabled.h"
#include "engine/integrators/control/rising_step.h"
#include "engine/integrators/table/default_method.h"
#include "engine/systems/articulation/link_bodies.h"

namespace truestep::articulation {

class Articulation final : public Tabled<Articulation, ForceSystem> {
 public:
  Articulation(std::unique_ptr<const ArticulationField> field, const ChosenMethod& method,
               const ArticulationDef& def);

  static const OutputTable& outputs();
  /// The links; their solids are built on first use.
  Ports ports() const override;
  void check(StateCheck& check, double t) const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  /// Open while torques act or a link is pushed.
  Energy::Exchange exchange(const State& state) const override;

 private:
  void add_method_stage(const std::string& why);
  void integrate(State& s, const StepInput& in) const;
  void draw_lines(PartDrawing& out) const;
  void draw_links(PartDrawing& out) const;
  struct Whole;
  Whole whole(const State& state, double t) const;
  std::vector<JointMark> joint_marks(const State& state) const;

  const ArticulationField& tree_;
  RisingStep rising_;
  double point_radius_;
  std::optional<Vec3> color_;
  mutable std::once_flag reached_;
  mutable std::unique_ptr<const LinkBodies> links_;
};

}  // namespace truestep::articulation
