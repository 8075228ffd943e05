// A parameter may have an alias: accepted, echoed as its name, and refused beside it.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/scene/params/params.h"
#include "engine/systems/rigid3d/rigid3d_def.h"

namespace truestep {
using namespace rigid3d;
namespace {

TEST(ParameterWords, AnotherWordIsReadAndEchoedAsTheName) {
  const auto* row = rigid3d_table().find("rest_speed");
  ASSERT_NE(row, nullptr);
  EXPECT_EQ(row->name, "restitution_speed");
  EXPECT_EQ(rigid3d_table().find("restitution_speed"), row);
  // The control.
  EXPECT_EQ(rigid3d_table().find("rest_sped"), nullptr);

  Rigid3dDef def;
  std::vector<Issue> issues;
  const auto read = [&](const char* text) {
    read_params(rigid3d_table(), &def, boost::json::parse(text).as_object(), "", {}, issues);
  };
  read(R"({"rest_speed": 0.3})");
  EXPECT_TRUE(issues.empty());
  const auto written = write_params(rigid3d_table(), &def);
  EXPECT_EQ(written.at("restitution_speed"), 0.3);
  EXPECT_FALSE(written.contains("rest_speed"));
  read(R"({"restitution_speed": 1, "rest_speed": 2})");
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].pointer, "/rest_speed");
}

}  // namespace
}  // namespace truestep
