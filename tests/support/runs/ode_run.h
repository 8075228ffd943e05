// A scene with one system, run without a server around it.
#pragma once
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "tests/support/runs/world_run.h"

namespace truestep::test {

/// All digits of a number.
inline std::string write_number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", v);
  return text;
}

struct OdeRun : testing_rig::WorldRun {
  /// `system`: the JSON object of the system without its type and id; `threads` of the arena.
  explicit OdeRun(const std::string& system, double dt = 0.1, int threads = 1)
      : WorldRun(R"({"schema_version": "1.0", "time": {"dt": )" + write_number(dt) +
                     R"(}, "systems": [{"type": "ode", "id": "s", )" + system + "}]}",
                 threads) {}

  OdeRun& steps(int n) {
    WorldRun::steps(n);
    return *this;
  }
  double value(const std::string& name) const {
    const auto v = world.observe(state).find("s." + name);
    EXPECT_TRUE(v.has_value()) << name;
    return v.value_or(0);
  }
  void set(const std::string& name, double to) {
    Command c;
    c.kind = CommandKind::set_parameter;
    c.system = "s", c.name = name, c.value = to;
    world.apply(state, c);
  }
  const State& columns() const { return s(); }
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
