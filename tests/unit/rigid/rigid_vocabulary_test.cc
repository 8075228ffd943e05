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
  // Absent in the plane: other axes, and what is not measured there.
  const Names absent = {"momentum.z",  "angular_momentum.x", "angular_momentum.y",
                        "joints.tilt", "joints.force",       "joints.torque"};
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
}

}  // namespace
}  // namespace truestep
