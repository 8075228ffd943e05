// A scene of one rigid2d system "r", from the members of its JSON object: step, look.
#pragma once
#include <cmath>
#include <string>

#include "engine/session/world/world.h"

namespace truestep::testing {

struct FlatTrial {
  explicit FlatTrial(const std::string& system, double dt = 1.0 / 60)
      : world(parse_scene(R"({"time": {"dt": )" + number(dt) +
                          R"(}, "systems": [{"type": "rigid2d", "id": "r", )" + system + "}]}")),
        state(world.initial_state()) {}
  static std::string number(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", x);
    return text;
  }
  FlatTrial& steps(int n) {
    for (int i = 0; i < n; ++i) world.step(state, workspace, arena, {});
    return *this;
  }
  State& s() { return state.systems[0]; }
  Vec3 position(size_t body) { return load3<double>(s().f64(s().at("position")).data(), body); }
  Vec3 velocity(size_t body) { return load3<double>(s().f64(s().at("velocity")).data(), body); }
  double spin(size_t body) { return s().f64(s().at("angular_velocity"))[body]; }
  double angle(size_t body) { return s().f64(s().at("angle"))[body]; }
  double observed(const char* name) {
    return world.observe(state).find(std::string("r.") + name).value_or(NAN);
  }
  World world;
  WorldState state;
  Workspace workspace;
  ThreadArena arena{1};
};

}  // namespace truestep::testing
