// Joints whose limits exclude each other and impossible inertias are refused with their pointer.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/geometry/mass_properties.h"
#include "engine/scene/json/json.h"
#include "engine/session/describe.h"

namespace truestep {
namespace {

std::vector<std::string> pointers(const std::string& system) {
  const auto report = validate_scene(parse_json(R"({"systems": [)" + system + "]}"), AdmissionLimits{});
  std::vector<std::string> out;
  for (const auto& e : report.at("errors").as_array()) out.push_back(e.at("pointer").as_string().c_str());
  return out;
}
using Pointers = std::vector<std::string>;

TEST(ImpossibleBodies, LimitsInThePlaneThatExcludeEachOther) {
  const auto joint = [](const std::string& text) {
    return pointers(R"({"type": "rigid2d", "bodies": [{"shapes": [{"type": "circle"}]}], "joints": [)" +
                    text + "]}");
  };
  EXPECT_EQ(joint(R"({"type": "revolute", "lower": 1, "upper": -1})"), Pointers{"/systems/0/joints/0/lower"});
  EXPECT_EQ(joint(R"({"type": "prismatic", "lower": 1, "upper": 0.5})"),
            Pointers{"/systems/0/joints/0/lower"});
  EXPECT_EQ(joint(R"({"type": "wheel", "lower": 1, "upper": 0.5})"), Pointers{"/systems/0/joints/0/lower"});
  EXPECT_EQ(joint(R"({"type": "distance", "anchor_b": [1, 0, 0], "minimum": 2, "maximum": 1})"),
            Pointers{"/systems/0/joints/0/minimum"});
  EXPECT_EQ(joint(R"({"type": "revolute", "lower": -1, "upper": 1})"), Pointers{});
}

TEST(ImpossibleBodies, InertiasThatNoBodyHas) {
  const auto link = [](const std::string& inertia) {
    return pointers(R"({"type": "articulation", "links": [{"mass": 1, "center": [1, 0, 0], "inertia": )" +
                    inertia + "}]}");
  };
  EXPECT_EQ(link("[1, 1, 3]"), Pointers{"/systems/0/links/0/inertia"});
  EXPECT_EQ(link("[1, 1, -0.1]"), Pointers{"/systems/0/links/0/inertia"});
  EXPECT_EQ(link("[1, 1, 1, 2, 0, 0]"), Pointers{"/systems/0/links/0/inertia"});
  // A disc and a rod are limiting cases.
  EXPECT_EQ(link("[1, 1, 2]"), Pointers{});
  EXPECT_EQ(link("[1, 0, 1]"), Pointers{});
  const auto body = [](const std::string& rest) {
    return pointers(R"({"type": "rigid3d", "bodies": [{"type": "sphere", )" + rest + "}]}");
  };
  EXPECT_EQ(body(R"("inertia": [1, 1, 3])"), Pointers{"/systems/0/bodies/0/inertia"});
  EXPECT_EQ(body(R"("inertia": [1, 0, 1])"), Pointers{"/systems/0/bodies/0/inertia"});
  EXPECT_EQ(body(R"("inertia": [1, 2])"), Pointers{"/systems/0/bodies/0/inertia"});
  EXPECT_EQ(body(R"("motion": "fixed", "inertia": [1, 1, 1])"), Pointers{"/systems/0/bodies/0/inertia"});
  EXPECT_EQ(body(R"("mass": 2, "inertia": [1, 1.5, 2.5])"), Pointers{});
}

TEST(ImpossibleBodies, TheTestLooksAtPrincipalMoments) {
  // A disc rotated out of its axes: the diagonal alone does not reveal it.
  const double c = std::cos(0.7), s = std::sin(0.7);
  const auto turned = [&](double a, double b, double z) {
    return Symmetric3{a * c * c + z * s * s, b, a * s * s + z * c * c, 0, (z - a) * c * s, 0};
  };
  EXPECT_FALSE(inertia_fault(turned(1, 1, 2)));
  EXPECT_TRUE(inertia_fault(turned(1, 1, 2.01)));
}

}  // namespace
}  // namespace truestep
