// Runs studies of a scene, which is an oscillator unless another is given.
#pragma once
#include <gtest/gtest.h>

#include <atomic>
#include <string>

#include "engine/scene/json/json.h"
#include "engine/studies/study.h"

namespace truestep::testing_rig {

inline constexpr const char* kOscillator = R"({"schema_version":"1.0","name":"oscillator",
  "time":{"dt":0.01,"duration":2},
  "systems":[{"type":"oscillator","id":"o","mass":1,"stiffness":100,"damping":2,"position":1,"velocity":0,
              "integrator":"rk4"}]})";

/// Studies without progress, until `cancelled`.
class Study : public ::testing::Test {
 protected:
  StudyResult run(const std::string& request) {
    return run_study(read_study_request(parse_json(request)), context);
  }
  static std::string with(const std::string& kind, const std::string& rest,
                          const std::string& scene = kOscillator) {
    return "{\"kind\":\"" + kind + "\",\"scene\":" + scene + (rest.empty() ? "" : "," + rest) + "}";
  }
  ThreadArena arena{2};
  std::atomic<bool> cancelled{false};
  StudyContext context{.arena = arena, .cancelled = cancelled, .progress = [](double, const std::string&) {}};
};

/// A cloth of 400 points for a minute: far beyond a budget of 2 s.
inline constexpr const char* kCloth = R"({"schema_version":"1.0","name":"cloth",
  "time":{"dt":0.005,"duration":60},
  "systems":[{"type":"mass_spring","id":"c","mass":0.001,"stiffness":50,"damping":0.0001,
              "pinned":["corner_00","corner_10"],"cloth_grid":{"nx":20,"ny":20}}]})";

}  // namespace truestep::testing_rig
