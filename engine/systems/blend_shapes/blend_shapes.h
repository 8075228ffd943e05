// The system type "blend_shapes": a surface that is a weighted sum of shapes, x = b + sum w_k (t_k - b)
// (kernels/animation/blend.h), with weights that are expressions of time and controls (animation/driver.h).
// Base and targets are lists of vertices (an OBJ or PLY file gives one), meshes of glTF files (shape_files.h)
// or expressions of the base's coordinates. Its triangles are published as immovable solids. Commands:
// set_parameter of a control.
#pragma once
#include <array>
#include <memory>

#include "engine/animation/driver.h"
#include "engine/core/def/build.h"
#include "engine/core/outputs.h"
#include "engine/core/outputs/tabled.h"
#include "engine/core/ports/morph_port.h"
#include "engine/core/system.h"
#include "engine/kernels/animation/blend.h"

namespace truestep::blend_shapes {

struct BallDef {
  double radius = 1;
  int rings = 24, around = 36;
};

struct TargetDef {
  std::string name, weight;
  std::vector<Vec3> vertices;
  std::vector<std::string> offset, gltf;
  std::string mesh;
};

struct BlendShapesDef : animation::DriverDef {
  std::vector<Vec3> vertices;
  std::vector<int64_t> triangles;
  std::optional<BallDef> ball;
  std::vector<std::string> gltf;
  std::string mesh;
  std::vector<std::string> base;
  std::vector<TargetDef> targets;
  std::vector<std::string> position, rotation;
  animation::EulerOrder order = animation::EulerOrder::xyz;
  std::optional<Vec3> color;
};

const DefTable& blend_shapes_table();
const Outputs& blend_shapes_outputs();
Cost blend_shapes_cost(const void* def);

class BlendShapes final : public Tabled<BlendShapes, StagedSystem>, public Morphed {
 public:
  BlendShapes(const BlendShapesDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  Ports ports() const override;
  Morphed::Port morph() const override;
  Pose morph_at(const State& state, double t, std::span<double> weights) const override;

 private:
  struct Scratch;
  void build_base(const BlendShapesDef& def);
  void add_target(const TargetDef& def, size_t number);
  /// Evaluates three expressions of x, y, z at the base's vertices; errors are reported to the driver.
  std::vector<Vec3> sampled(const std::string& pointer, const std::vector<std::string>& texts);
  void update(State& state, double t, double h, Scratch& scratch) const;

  animation::Driver driver_;
  double dt_;
  std::vector<Vec3> base_;
  std::vector<std::array<uint32_t, 3>> triangles_;
  std::vector<std::string> names_;
  std::vector<animation::ShapeOffsets> targets_;
  std::vector<size_t> weights_;  ///< outputs
  size_t position_ = 0, rotation_ = 0;
  animation::EulerOrder order_;
  std::optional<Vec3> color_;
};

std::unique_ptr<const System> build_blend_shapes(const void* def, const BuildContext& context);

}  // namespace truestep::blend_shapes
