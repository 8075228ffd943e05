// What a scene says about a system of ordinary differential equations; read by ode_model.cc.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/equations/integrator_def.h"
#include "engine/core/outputs.h"

namespace truestep::ode {

/// Massless points carried by a velocity field v(x, y, z, t).
struct TracersDef {
  std::vector<NamedText> velocity;  ///< of x, y and z; a missing one is 0
  int count = 0;                    ///< drawn at random inside the box
  std::vector<int64_t> grid;        ///< nx, ny, nz points, evenly over the box
  std::vector<Vec3> points;
  Vec3 box_min{-1, -1, 0}, box_max{1, 1, 0};
  enum class Method : uint8_t { euler, midpoint, heun, rk4 } method = Method::rk4;
};

/// Something that happens at a time, periodically, or when an expression crosses zero.
struct OdeEventDef {
  std::string name;
  std::optional<double> at, every;
  std::string when;
  enum class Direction : uint8_t { any, rising, falling } direction = Direction::any;
  std::vector<NamedText> set;
  enum class Then : uint8_t { go_on, stop } then = Then::go_on;
};

/// Relative and absolute tolerance of adaptive methods unless a scene says otherwise.
inline constexpr double kOdeTolerance = 1e-8;

struct OdeDef : IntegratorParams {
  std::vector<NamedNumbers> states, velocities, parameters;
  std::vector<NamedText> let, equations, second, invariants;
  std::vector<OdeEventDef> events;
  std::optional<TracersDef> tracers;
  std::vector<NamedNumbers> absolute_tolerances;
  std::vector<std::string> plot, axes, curves;
  std::optional<double> max_step;
  std::optional<int> trail;
  double draw_radius = 0.02;
  std::optional<Vec3> color;
};

const DefTable& ode_table();
/// Its outputs.
const Outputs& ode_outputs();
Cost ode_cost(const void* def);

}  // namespace truestep::ode
