// Links as bodies for couplings. An impulse at a link acts through the inverse joint-space inertia,
//   dq' = M^-1 J^T (J, T),   loops closed,
// one articulated body solve in O(n) each, so all links respond as the joints allow. A position correction
// moves q in the same way. For a tree with a free root it conserves momentum: the change of momentum from
// moving at unchanged q' is returned as an impulse on the root, to which the joints respond as to any other.
// Trees attached to the ground keep q'.
#pragma once
#include <deque>

#include "engine/core/ports/body_carrier.h"
#include "engine/geometry/solid.h"
#include "engine/systems/articulation/articulation_field.h"

namespace truestep::articulation {

struct LinkResponse;

class LinkBodies final : public BodyAccess, public BodyCarrier {
 public:
  explicit LinkBodies(const ArticulationField& field);

  /// One per link, in the frame at its centre of mass with the link's axes.
  std::span<const BodyForm> forms() const { return forms_; }

  void wake(State&, size_t) const override {}
  const BodyCarrier* carrier() const override { return this; }
  void forget(Workspace& memory) const override;
  size_t count() const override { return forms_.size(); }
  uint32_t form(const State&, size_t row) const override { return static_cast<uint32_t>(row); }
  BodyMotion motion(const State& state, size_t row) const override;
  void motions(const State& state, std::span<BodyMotion> out, Workspace& memory) const override;
  BodyTwist answer(const State& state, size_t row, const BodyImpulse& on, Workspace& memory) const override;
  void answers(const State& state, std::span<const BodyImpulse> on, std::span<BodyTwist> out,
               Workspace& memory) const override;
  void push(State& state, size_t row, const BodyImpulse& on, Workspace& memory) const override;
  void shift(State& state, size_t row, const BodyImpulse& by, const Vec3& gained,
             Workspace& memory) const override;
  /// See carried_links.h.
  void carry(State& state, std::span<const BodyMotion> to, std::span<const uint8_t> given,
             Workspace& memory) const override;

 private:
  struct Scratch;
  void pose(const State& state, Scratch& scratch) const;
  const LinkResponse& response(const State& state, size_t row, Scratch& scratch) const;
  const LinkResponse& response_now(const State& state, size_t row, Scratch& scratch) const;
  Push push_of(size_t row, const BodyImpulse& on) const;
  std::span<double> respond(const State& state, Scratch& scratch) const;
  BodyTwist twist_of(size_t row, Scratch& scratch) const;
  spatial::Force momentum(const State& state, int32_t root, Scratch& scratch) const;

  const ArticulationField& field_;
  std::deque<Solid> solids_;  // a deque, so that addresses stay valid
  std::vector<BodyForm> forms_;
  std::vector<int32_t> root_of_;    // of every node
  std::vector<int32_t> free_root_;  // of every link: the node of its tree's free root, or kGround
};

}  // namespace truestep::articulation
