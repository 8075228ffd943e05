// The coupling type "contact": points of one side against the solids that the other publishes. With the place
// q = sum b_i x_i on the solid (b_i: barycentric weights), u = v_p - sum b_i v_i and K = w_p + sum b_i^2 w_i,
// an impulse J = du / K on the point and -b_i J on the corners changes u by du: momentum is exchanged, not
// created, and the laws for a point on a wall (kernels/contact/contact_response.h: restitution, Coulomb
// friction, support) apply to u. A touch is answered at its own time within the substep; from there both
// sides continue with the new velocities. A cloth's points are pushed with weights b_i as in Bridson, Fedkiw,
// Anderson 2002, "Robust treatment of collisions, contact and friction for cloth animation", section 7.1. The
// points of a are searched against the solids of b, or the other way round if b has only balls and a has more
// than that. Points never pass triangles: contact_guard.h runs last, after all couplings, without
// restitution. Not covered: edges of two cloths against each other. Points do not spin, so friction at the
// distance of their radii loses angular momentum; without friction it is conserved.
#pragma once
#include <memory>

#include "engine/core/changing_triangles.h"
#include "engine/core/coupling.h"
#include "engine/couplings/contact/contact_def.h"
#include "engine/couplings/contact/contact_search.h"
#include "engine/couplings/exchange.h"

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
  /// Whose points are tested against whose solids.
  enum class Roles : uint8_t { a_on_b, b_on_a, on_itself };
  ContactCoupling(const ContactDef& def) : def_(def) {}
  SolidList solids(const State& state, const Points& of) const;

  ContactDef def_;
  Roles roles_ = Roles::a_on_b;
  std::string points_id_, solids_id_;
  PointPort points_, other_;
  SolidsOf published_;
  double reach_ = 0;  ///< m, distance at which a point touches
};

std::unique_ptr<const Coupling> build_contact(const void* def, const CouplingContext& context);

}  // namespace truestep::contact
