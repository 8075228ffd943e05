// What a system's factory is given besides its own parameters, and the cost that it estimates in advance.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "engine/core/equations/integrator.h"
#include "engine/math/vec3.h"

namespace truestep {

/// The scene around a system.
struct BuildContext {
  std::string id;             ///< the system's id, unique in its scene
  Vec3 gravity{0, -9.81, 0};  ///< m/s^2
  double dt = 1.0 / 60;       ///< s, length of one substep of this scene
  uint64_t seed = 0;          ///< already mixed with the system's index: systems draw different numbers
  /// Whether a coupling lets its points touch bodies: the default method is then one in which each point
  /// responds for itself.
  bool meets_bodies = false;
};

/// Estimate from counts alone, before anything is allocated; doubles so that nothing overflows.
struct Cost {
  double state_bytes = 0;
  double workspace_bytes = 0;
  double elements = 0;          ///< particles + springs + ...
  double seconds_per_step = 0;  ///< on one core of a current server
  double settles = 0;           ///< s of a system's own steps before time starts
  double start_seconds = 0;     ///< what these take on one core, of a whole scene
};

/// Integrator part of a scene's system object: "integrator": "rk4" with its settings.
struct IntegratorChoice {
  std::string name;  ///< empty: the system's default
  IntegratorOptions options;
};

}  // namespace truestep
