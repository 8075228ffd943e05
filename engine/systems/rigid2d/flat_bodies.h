// Bodies of the plane as couplings see them: prisms along z, in each direction twice as deep as the body
// reaches, whose position, velocity and rotation stay in the plane. Impulse components out of the plane are
// dropped:
//   dv = (Jx, Jy, 0) / m,   dw = (0, 0, Tz) / I.
// Rounded outlines are exact. Chains, and all shapes of a body with chains, become surfaces with kSides flat
// sides for round parts.
#pragma once
#include <deque>
#include <vector>

#include "engine/core/ports/body_port.h"
#include "engine/geometry/solid.h"
#include "engine/systems/rigid2d/model.h"

namespace truestep::rigid2d {

class FlatBodies final : public BodyAccess {
 public:
  explicit FlatBodies(const Model& model);

  /// Forms of every body, of every body while it is held, and of an absent body.
  std::span<const BodyForm> forms() const { return forms_; }

  Space space() const override { return Space::plane; }
  size_t count() const override { return model_.count(); }
  void wake(State& state, size_t row) const override;
  uint32_t form(const State& state, size_t row) const override;
  BodyMotion motion(const State& state, size_t row) const override;
  void motions(const State& state, std::span<BodyMotion> out, Workspace& memory) const override;
  BodyTwist answer(const State& state, size_t row, const BodyImpulse& on, Workspace& memory) const override;
  void answers(const State& state, std::span<const BodyImpulse> on, std::span<BodyTwist> out,
               Workspace& memory) const override;
  void push(State& state, size_t row, const BodyImpulse& on, Workspace& memory) const override;
  void shift(State& state, size_t row, const BodyImpulse& by, const Vec3& gained,
             Workspace& memory) const override;

 private:
  BodyTwist answer(const State& state, size_t row, const BodyImpulse& on) const;

  const Model& model_;
  std::deque<Solid> solids_;  // keeps its places
  std::vector<BodyForm> forms_;
};

}  // namespace truestep::rigid2d
