// Messages at failures and limits: remedies that equations do not have, and rules that a table's sentences
// must name. (What is told of equations that fail is in tests/scenes/equations/failures_name_the_state.json.)
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/scene/catalogue.h"
#include "engine/scene/json/json_write.h"
#include "engine/scene/params/params.h"
#include "engine/session/session.h"

namespace truestep {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Session session_of(const std::string& system, double dt = 0.01) {
  return Session(std::make_shared<const World>(parse_scene(R"({"time": {"dt": )" + std::to_string(dt) +
                                                           R"(}, "systems": [)" + system + "]}")),
                 std::make_shared<const ThreadArena>(1));
}
Session equations(const std::string& rest) {
  return session_of(R"({"type": "ode", "id": "s", )" + rest + "}");
}
std::string all(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& s : sentences) text += s + "\n";
  return text;
}

// A solution that ends: no method continues it, so none is offered, nor the stiffness and mass that equations
// do not have.
TEST(FaultWords, RemediesOfASolutionThatEnds) {
  Session s = equations(R"("states": {"x": 1}, "equations": {"x": "x^3"})");
  s.step(100);
  ASSERT_TRUE(s.failure());
  const std::string remedies = all(s.failure()->remedies);
  EXPECT_THAT(remedies, HasSubstr("a look at the equations"));
  EXPECT_THAT(remedies, Not(HasSubstr("mass")));
  EXPECT_THAT(remedies, Not(HasSubstr("integrator")));
  EXPECT_THAT(remedies, Not(HasSubstr("tolerance")));
}

/// The table of a kind as text: names and sentences.
std::string table_of(std::string_view kind) {
  for (const CatalogueRow& row : catalogue()) {
    if (row.type == kind) return write_json(schema_of(*row.table));
  }
  return {};
}

TEST(FaultWords, TablesSayTheRulesThatTheyCheck) {
  EXPECT_THAT(table_of("rigid3d"), HasSubstr("must be at right angles to axis"));
  EXPECT_THAT(table_of("particles"), HasSubstr("either rate or bursts, not both"));
  EXPECT_THAT(table_of("particles"), HasSubstr("either bursts or rate, not both"));
}

}  // namespace
}  // namespace truestep
