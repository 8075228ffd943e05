// Links as couplings reach them. An impulse at a link acts through the inverse joint-space inertia,
//   dq' = M^-1 J^T (J, T),   loops closed,
// one articulated body solve in O(n) each, so that all links answer as the joints let them. A correction of
// place moves q as far. A tree whose root is free keeps its momentum in that: what moving at unchanged q' has
// changed of it is given back as an impulse on the root (the joints answer to that as to any). What hangs
// from the ground keeps q'.
#pragma once
#include <deque>

#include "engine/core/body_carrier.h"
#include "engine/geometry/solid.h"
#include "engine/systems/articulation/articulation_field.h"

namespace truestep::articulation {

struct LinkResponse;

class LinkBodies final : public BodyAccess, public BodyCarrier {
 public:
  explicit LinkBodies(const ArticulationField& field);

  /// One per link, in the frame of its centre with the link's axes.
  std::span<const BodyForm> forms() const { return forms_; }

  void wake(State&, size_t) const override {}
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
  std::deque<Solid> solids_;  // keeps its places
  std::vector<BodyForm> forms_;
  std::vector<int32_t> root_of_;    // of every node
  std::vector<int32_t> free_root_;  // of every link: the node that carries its tree's free root, or kGround
};

}  // namespace truestep::articulation
