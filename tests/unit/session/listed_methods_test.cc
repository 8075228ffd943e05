// The integrators that GET /v1/systems/{type} lists are those that scenes of the type accept.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "engine/session/describe.h"

namespace truestep {
namespace {

std::set<std::string> listed(std::string_view type) {
  std::set<std::string> names;
  const auto described = describe_system(*find_system_type(type));
  for (const auto& row : described.at("integrators").as_array()) {
    names.emplace(row.at("name").as_string().c_str());
  }
  return names;
}

/// What the fault of a scene with a method that suits no such equations says is allowed.
std::set<std::string> accepted(const std::string& system) {
  const std::string scene = R"({"systems": [{)" + system + R"(, "integrator": "vertex_block_descent"}]})";
  const auto answer = validate_scene(boost::json::parse(scene), {});
  std::set<std::string> names;
  const auto& errors = answer.at("errors").as_array();
  if (errors.size() != 1) return names;
  EXPECT_EQ(errors[0].at("pointer").as_string(), "/systems/0/integrator");
  const std::string allowed(errors[0].at("allowed").as_string());
  for (size_t at = 0; at < allowed.size();) {
    const size_t end = std::min(allowed.find(", ", at), allowed.size());
    names.insert(allowed.substr(at, end - at));
    at = end + 2;
  }
  return names;
}

TEST(ListedMethods, AreThoseThatScenesAccept) {
  EXPECT_EQ(listed("heat"), accepted(R"("type": "heat", "cells": [8])"));
  EXPECT_EQ(listed("wave"), accepted(R"("type": "wave", "cells": [8])"));
  EXPECT_EQ(listed("ode"),
            accepted(R"("type": "ode", "states": {"x": 1}, "velocities": {"x": 0}, "second": {"x": "-x"})"));
  // Controls: methods of second-order equations serve waves only, those of forces neither.
  EXPECT_TRUE(listed("wave").contains("velocity_verlet"));
  EXPECT_FALSE(listed("heat").contains("velocity_verlet"));
  EXPECT_TRUE(listed("mass_spring").contains("vertex_block_descent"));
  EXPECT_FALSE(listed("wave").contains("vertex_block_descent"));
}

}  // namespace
}  // namespace truestep
