// The coupling type "contact": points of one side against the solids that the other publishes. With the place
// q = sum b_i x_i on the solid (b_i: barycentric weights), u = v_p - sum b_i v_i and K = w_p + sum b_i^2 w_i,
// an impulse J = du / K on the point and -b_i J on the corners changes u by du: momentum is exchanged, not
// created, and the laws for a point on a wall (kernels/contact/contact_response.h: restitution, Coulomb
// friction, support) apply to u. A touch is answered at its own time within the substep; from there both
// sides continue with the new velocities. A cloth's points are pushed with weights b_i as in Bridson, Fedkiw,
// Anderson 2002, "Robust treatment of collisions, contact and friction for cloth animation", section 7.1. The
// points of either side are searched against the triangles and capsules of the other, so that neither a
// corner passes a coarse cloth nor a point of a fine one a coarse face; balls against balls once. Points
// never pass triangles: contact_guard.h runs last, after all couplings, without restitution. Not covered:
// edges of two cloths against each other. Points do not spin, so friction at the distance of their radii
// loses angular momentum; without friction it is conserved.
#pragma once
#include <memory>
#include <vector>

#include "engine/core/coupling.h"
#include "engine/couplings/contact/points_on_solids.h"

namespace truestep::contact {

class ContactCoupling final : public Coupling {
 public:
  /// Error "scene_invalid" when a side has no points, or the two can never touch.
  static std::unique_ptr<const ContactCoupling> make(const ContactDef& def, const CouplingContext& context);

  State initial_state() const override;
  void begin(const CoupledStates& s, const StepInput& input) const override;
  void midway(const CoupledStates& s, const StepInput& input) const override;
  void end(const CoupledStates& s, const StepInput& input) const override;
  bool guard(const CoupledStates& s, const StepInput& input) const override;
  /// The exchange, and the contacts of the last substep (1).
  void observe(const ConstCoupledStates& s, Observables& out) const override;
  std::vector<PlanRow> plan() const override;

 private:
  ContactCoupling() = default;

  std::vector<PointsOnSolids> ways_;
  double friction_ = 0;
};

std::unique_ptr<const Coupling> build_contact(const void* def, const CouplingContext& context);

}  // namespace truestep::contact
