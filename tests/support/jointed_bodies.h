// Bodies that are not free in space (links of a tree, bodies of the plane) and balls that rain on them: for
// tests of what couplings do to them.
#pragma once
#include <cstdio>

#include "engine/base/random.h"
#include "tests/support/coupled.h"

namespace truestep::testing_coupled {

inline Vec3 random_vec(uint64_t stream, uint64_t i) {
  const auto u = uniform4(29, stream, i);
  return {2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1};
}

/// A free trunk with two limbs on a ball and a hinge, in slow motion.
inline constexpr const char* kBody = R"({"type": "articulation", "id": "doll", "links": [
    {"id": "trunk", "parent": "ground", "joint": "free", "q": [0.1, -0.2, 0.3, 0.9950371902099892, 0.09950371902099893, 0, 0],
     "v": [0.1, 0.2, -0.1, 0.3, -0.2, 0.5], "shapes": [{"type": "box", "half_extents": [0.3, 0.4, 0.2]}]},
    {"id": "arm", "parent": "trunk", "joint": "spherical", "offset": [0.35, 0.3, 0], "v": [0.2, 0.5, -0.4],
     "shapes": [{"type": "capsule", "radius": 0.1, "half_length": 0.3, "position": [0.4, 0, 0], "rotation": [0, 0, 1.2]}]},
    {"id": "hand", "parent": "arm", "joint": "revolute", "offset": [0.8, 0, 0], "q": [0.4], "v": [1],
     "shapes": [{"type": "box", "half_extents": [0.15, 0.1, 0.05], "position": [0.15, 0, 0]}]}]})";

inline std::string scene_of(const std::string& systems, const std::string& couplings, double dt = 0.004,
                            const char* gravity = "[0, 0, 0]") {
  return R"({"gravity": )" + std::string(gravity) + R"(, "time": {"dt": )" + std::to_string(dt) +
         R"(}, "systems": [)" + systems + R"(], "couplings": [)" + couplings + "]}";
}

/// 120 balls that rain on a place from one side.
inline std::string dust(const Vec3& from, const Vec3& speed, const Vec3& spread, double radius = 0.02) {
  std::string x, v;
  for (uint64_t i = 0; i < 120; ++i) {
    const Vec3 r = random_vec(7, i), u = random_vec(8, i) * 0.5;
    const double flat = spread.z > 0 ? 1 : 0;
    char text[160];
    std::snprintf(text, sizeof text, "%s[%.5f, %.5f, %.5f]", i ? ", " : "", from.x + r.x * spread.x,
                  from.y + r.y * spread.y, flat * (from.z + r.z * spread.z));
    x += text;
    std::snprintf(text, sizeof text, "%s[%.5f, %.5f, %.5f]", i ? ", " : "", speed.x + u.x, speed.y + u.y,
                  flat * (speed.z + u.z));
    v += text;
  }
  return R"({"type": "particles", "id": "dust", "mass": 1, "radius": )" + std::to_string(radius) +
         R"(, "positions": [)" + x + R"(], "velocities": [)" + v + "]}";
}

inline constexpr const char* kFlat = R"({"type": "rigid2d", "id": "flat", "precision": "f64", "bodies": [
    {"position": [0, 0, 0], "angle": 0.3, "angular_velocity": 0.7, "shapes": [{"type": "box", "half_extents": [0.6, 0.2, 0], "radius": 0.05}], "density": 100},
    {"position": [1.4, -0.3, 0], "velocity": [-0.2, 0.1, 0], "shapes": [{"type": "circle", "radius": 0.3}, {"type": "circle", "radius": 0.2, "center": [0.4, 0, 0]}], "density": 100},
    {"position": [-1.4, 0.1, 0], "shapes": [{"type": "polygon", "points": [[-0.3, -0.3, 0], [0.4, -0.2, 0], [0, 0.5, 0]]}], "density": 100}]})";

}  // namespace truestep::testing_coupled
