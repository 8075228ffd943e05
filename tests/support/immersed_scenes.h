// Scenes of rigid bodies in water.
#pragma once
#include <string>

#include "tests/support/coupled.h"

namespace truestep::testing_coupled {

inline std::string number(double v) {
  char out[32];
  std::snprintf(out, sizeof out, "%.17g", v);
  return out;
}
inline std::string triple(const Vec3& v) {
  return "[" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + "]";
}

/// Water up to `depth` in a box of the given size, with room cut out for a body in it.
struct Bath {
  Vec3 size{0.6, 0.6, 0.6};
  double depth = 0.3, spacing = 0.025, dt = 1.0 / 60;
  std::string body, hollow, water;  ///< members of the body, of the hollow, and further ones of the water
  Vec3 gravity{0, -9.81, 0};

  std::string scene() const {
    const Vec3 half{size.x / 2, depth / 2, size.z / 2};
    return R"({"time": {"dt": )" + number(dt) + R"(}, "gravity": )" + triple(gravity) + R"(, "systems": [
      {"type": "rigid3d", "id": "crates", "bodies": [{)" +
           body + R"(}]},
      {"type": "sph", "id": "water", "low": [0, 0, 0], "high": )" +
           triple(size) + R"(, "spacing": )" + number(spacing) + R"(, "bodies": [{"center": )" +
           triple(half) + R"(, "half_extents": )" + triple(half) + "}]" +
           (hollow.empty() ? "" : R"(, "hollows": [{)" + hollow + "}]") + water +
           R"(}], "couplings": [{"type": "immersion", "id": "afloat", "a": "crates", "b": "water"}]})";
  }
};

}  // namespace truestep::testing_coupled
