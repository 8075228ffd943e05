// The system type "keyframes": shapes whose poses are expressions of time, controls, paths and turns
// (animation/driver.h), published as immovable bodies with the velocities of their motion, so that cloth and
// particles collide with them. Shapes with a scale (squash and stretch) are separate surfaces; if all shapes
// are such, their triangles are published instead. Controls without shapes serve couplings that drive other
// systems. Commands: set_parameter of a control.
#pragma once
#include <memory>

#include "engine/animation/driver.h"
#include "engine/animation/moved_bodies.h"
#include "engine/core/outputs/tabled.h"
#include "engine/core/system.h"
#include "engine/geometry/solid.h"
#include "engine/systems/keyframes/keyframes_def.h"

namespace truestep::keyframes {

/// Columns of a state.
struct MovedColumns {
  static constexpr animation::MovedBodies kBodies = animation::MovedBodies::from(0);
  enum Index : State::Column {
    kControl = animation::MovedBodies::kCount,
    kSkin,
    kSkinVelocity,
    kSkinInverseMass,
    kValue
  };
};

class Keyframes final : public Tabled<Keyframes, StagedSystem> {
 public:
  Keyframes(const KeyframesDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  Ports ports() const override;

 private:
  struct Shape {
    MovedShapeDef def;
    size_t position = 0, rotation = 0, scale = 0;  ///< index of the first of three outputs
    std::optional<size_t> turn;
    size_t first_vertex = 0;
    std::vector<Vec3> vertices;  ///< none: rigid
  };
  struct Scratch;
  void add_shape(const MovedShapeDef& def, size_t number);
  /// Sets everything to time t; velocities from the state's previous poses, which are h earlier.
  void update(State& state, double t, double h, Scratch& scratch) const;

  animation::Driver driver_;
  double dt_;
  std::vector<Shape> shapes_;
  std::vector<Solid> solids_;
  std::vector<BodyForm> forms_;
  std::vector<std::array<uint32_t, 3>> triangles_;
  size_t vertices_ = 0;
  std::vector<size_t> stretched_;  ///< shapes with a scale, each a part
  std::vector<size_t> named_;      ///< shapes with an id
  bool rigid_ = false;             ///< whether any shape has none
};

std::unique_ptr<const System> build_keyframes(const void* def, const BuildContext& context);

}  // namespace truestep::keyframes
