// rigid2d and rigid3d say the same things with the same words: an observable of the plane has the name that
// it has in space, and so has what joints of both kinds have in common.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "engine/core/outputs.h"
#include "engine/scene/catalogue.h"

namespace truestep {
namespace {

using Names = std::set<std::string>;

Names observables(const char* type) {
  Names names;
  for (const auto& o : find_system_type(type)->outputs->observables) names.insert(std::string(o.name));
  return names;
}

/// Parameters of all alternatives of a `variants` parameter.
Names words(const char* type, const char* parameter) {
  Names names;
  for (const ParamRow& row : find_system_type(type)->table->rows) {
    if (row.name != parameter) continue;
    for (const ParamVariant& variant : row.variants) {
      for (const ParamRow& r : variant.table->rows) names.insert(r.name);
    }
  }
  return names;
}

TEST(RigidVocabulary, ObservablesOfThePlaneHaveTheirNamesInSpace) {
  const Names plane = observables("rigid2d"), space = observables("rigid3d");
  for (const std::string& name : plane) EXPECT_TRUE(space.count(name)) << name;
  // Absent in the plane: other axes.
  const Names absent = {"momentum.z", "angular_momentum.x", "angular_momentum.y"};
  for (const std::string& name : space) {
    if (name.rfind("joint.<id>.", 0) == 0) continue;
    EXPECT_NE(plane.count(name), absent.count(name)) << name;
  }
}

TEST(RigidVocabulary, JointsShareTheirCommonWords) {
  const Names plane = words("rigid2d", "joints"), space = words("rigid3d", "joints");
  EXPECT_TRUE(plane.count("collide")) << "control: the words are found";
  EXPECT_TRUE(space.count("collide"));
  EXPECT_FALSE(space.count("touch"));
  for (const char* word : {"id",
                           "a",
                           "b",
                           "anchor",
                           "break_force",
                           "break_torque",
                           "lower",
                           "upper",
                           "stiffness",
                           "damping",
                           "hertz",
                           "damping_ratio",
                           "rest",
                           "motor_speed",
                           "motor_target",
                           "max_motor",
                           "motor_rate",
                           "length",
                           "minimum",
                           "maximum",
                           "move",
                           "turn",
                           "rate",
                           "max_force",
                           "max_torque",
                           "ratio",
                           "velocity",
                           "anchor_b",
                           "angular_velocity"}) {
    EXPECT_TRUE(plane.count(word) && space.count(word)) << word;
  }
  // What the words of the plane were before.
  for (const char* word : {"offset", "correction", "spring_hertz"}) EXPECT_FALSE(plane.count(word)) << word;
}

TEST(RigidVocabulary, FieldsOfThePlaneHaveTheirNamesInSpace) {
  const auto fields = [](const char* type) {
    Names names;
    for (const auto& f : find_system_type(type)->outputs->fields) names.insert(std::string(f.name));
    return names;
  };
  const Names plane = fields("rigid2d"), space = fields("rigid3d");
  for (const std::string& name : plane) EXPECT_EQ(space.count(name), name != "angle") << name;
  // Bodies in the plane have no single shape and size.
  for (const std::string& name : space)
    EXPECT_EQ(plane.count(name), name != "shape" && name != "size") << name;
}

}  // namespace
}  // namespace truestep
