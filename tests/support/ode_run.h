// A scene with one system, run without a server around it.
#pragma once
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "engine/session/world/world.h"

namespace truestep::test {

/// All digits of a number.
inline std::string write_number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", v);
  return text;
}

class OdeRun {
 public:
  /// `system`: the JSON object of the system without its type and id; `threads` of the arena.
  explicit OdeRun(const std::string& system, double dt = 0.1, int threads = 1)
      : world_(parse_scene(R"({"schema_version": "1.0", "time": {"dt": )" + write_number(dt) +
                           R"(}, "systems": [{"type": "ode", "id": "s", )" + system + "}]}")),
        arena_(threads),
        state(world_.initial_state()) {}

  OdeRun& steps(int n) {
    for (int k = 0; k < n; ++k) world_.step(state, workspace, arena_, {});
    return *this;
  }
  double value(const std::string& name) const {
    const auto v = world_.observe(state).find("s." + name);
    EXPECT_TRUE(v.has_value()) << name;
    return v.value_or(0);
  }
  void set(const std::string& name, double to) {
    Command c;
    c.kind = CommandKind::set_parameter;
    c.system = "s", c.name = name, c.value = to;
    world_.apply(state, c);
  }
  const World& world() const { return world_; }
  const State& columns() const { return state.systems[0]; }

 private:
  World world_;
  ThreadArena arena_;

 public:
  WorldState state;
  Workspace workspace;
};

/// The errors with which a system is refused, when parsed or built.
inline std::vector<Issue> ode_faults(const std::string& system) {
  try {
    OdeRun run(system);
  } catch (const Error& e) {
    return e.issues();
  }
  return {};
}

}  // namespace truestep::test
