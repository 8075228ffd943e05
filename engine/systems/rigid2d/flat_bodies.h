// Bodies of the plane as couplings reach them: prisms along z, twice as deep either way as the body reaches,
// whose place, velocity and turning stay in the plane. An impulse across it is not taken:
//   dv = (Jx, Jy, 0) / m,   dw = (0, 0, Tz) / I.
// Rounded outlines are met exactly. Chains are met as surfaces, and all else of a body with chains, too, with
// kSides flat sides for what is round.
#pragma once
#include <deque>
#include <vector>

#include "engine/core/body_port.h"
#include "engine/geometry/solid.h"
#include "engine/systems/rigid2d/model.h"

namespace truestep::rigid2d {

class FlatBodies final : public BodyAccess {
 public:
  explicit FlatBodies(const Model& model);

  /// Of every body, of every body while it is held, and of what is not there.
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
