// What is said of a value in a scene, in what form expressions are kept, and which name is near another.
// Faults by pointer and suggestion are in tests/scenes/refused.
#include <gtest/gtest.h>

#include <map>

#include "engine/base/text/nearest_name.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/session/describe.h"

namespace truestep {
namespace {

/// Faults by pointer.
std::map<std::string, boost::json::object> faults(const std::string& text) {
  const boost::json::object report = validate_scene(parse_json(text), AdmissionLimits{});
  std::map<std::string, boost::json::object> out;
  for (const auto& e : report.at("errors").as_array())
    out[e.at("pointer").as_string().c_str()] = e.as_object();
  EXPECT_EQ(report.at("valid").as_bool(), out.empty());
  return out;
}

std::string text_of(const boost::json::object& issue, const char* key) {
  const auto* v = issue.if_contains(key);
  return v ? v->as_string().c_str() : "";
}

TEST(SceneFaults, ExpressionsMayBeNumbers) {
  const auto rod = [](const char* diffusivity) {
    return std::string(R"({"systems": [{"type": "heat", "id": "rod", "cells": [8], "diffusivity": )") +
           diffusivity + "}]}";
  };
  const auto canonical = [&](const char* diffusivity) {
    return parse_scene(rod(diffusivity))
        .canonical()
        .at("systems")
        .as_array()[0]
        .at("diffusivity")
        .as_string();
  };
  EXPECT_EQ(canonical("0.25"), "0.25");
  EXPECT_EQ(canonical(R"("0.25")"), "0.25");
}

TEST(SceneFaults, NoValueIsShownWhereThereIsNone) {
  const auto missing = faults(R"({"systems": [{"type": "mass_spring", "rope": {"from": [0, 0, 0]}}]})");
  EXPECT_EQ(text_of(missing.at("/systems/0/rope/to"), "value"), "");
}

TEST(SceneFaults, GalleryHasNone) {
  for (const GalleryScene& g : gallery()) EXPECT_TRUE(faults(std::string(g.text)).empty()) << g.name;
}

TEST(NearestName, OnlyNamesThatAreNear) {
  const std::vector<std::string> names{"s", "mass", "stiffness", "gravity", "angular_velocity"};
  EXPECT_EQ(nearest_name("zz", names), "");
  EXPECT_EQ(nearest_name("q", names), "");
  EXPECT_EQ(nearest_name("mas", names), "mass");
  EXPECT_EQ(nearest_name("msas", names), "mass");
  EXPECT_EQ(nearest_name("stifness", names), "stiffness");
  EXPECT_EQ(nearest_name("grvty", names), "gravity");
  EXPECT_EQ(nearest_name("stiff", names), "stiffness");
  EXPECT_EQ(nearest_name("velocity", names), "angular_velocity");
  EXPECT_EQ(nearest_name("temperature", names), "");
}

}  // namespace
}  // namespace truestep
