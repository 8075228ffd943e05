// A scene of one rigid2d system "r", from the members of its JSON object.
#pragma once
#include <string>

#include "tests/support/runs/world_run.h"

namespace truestep::testing {

struct FlatTrial : testing_rig::WorldRun {
  explicit FlatTrial(const std::string& system, double dt = 1.0 / 60)
      : WorldRun(R"({"time": {"dt": )" + number(dt) + R"(}, "systems": [{"type": "rigid2d", "id": "r", )" +
                 system + "}]}") {}
  static std::string number(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", x);
    return text;
  }
  FlatTrial& steps(int n) {
    WorldRun::steps(n);
    return *this;
  }
};

}  // namespace truestep::testing
