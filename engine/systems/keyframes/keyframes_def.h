// What a scene says about shapes with prescribed motion; read by keyframes.cc.
#pragma once
#include "engine/animation/driver_def.h"
#include "engine/core/def/build.h"
#include "engine/core/outputs.h"

namespace truestep::keyframes {

enum class ShapeType : uint8_t { sphere, box, capsule, cylinder };

struct MovedShapeDef {
  std::string id;
  ShapeType shape = ShapeType::sphere;
  double radius = 0.1, half_length = 0.2;  ///< m
  Vec3 half_extents{0.1, 0.1, 0.1};        ///< m
  std::vector<std::string> position, rotation, scale;
  animation::EulerOrder order = animation::EulerOrder::xyz;
  std::string turn;
  std::optional<Vec3> color;
};

struct KeyframesDef : animation::DriverDef {
  std::vector<MovedShapeDef> shapes;
};

const DefTable& keyframes_table();
const Outputs& keyframes_outputs();
Cost keyframes_cost(const void* def);

}  // namespace truestep::keyframes
