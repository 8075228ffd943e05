// Observables that take a pass of their own are computed only for those who ask for them: a series of the
// energy of a liquid took as long as its steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/session/session.h"

namespace truestep {
namespace {

std::shared_ptr<const World> make_world(const std::string& more = "") {
  return std::make_shared<const World>(parse_scene(R"({"time": {"dt": 0.01}, "systems": [
    {"type": "sph", "id": "water", "dimension": 2, "spacing": 0.1,
     "bodies": [{"center": [0.5, 0.3, 0], "half_extents": [0.5, 0.3, 1]}]},
    {"type": "flocking", "id": "birds", "count": 20}])" +
                                                   more + "}"));
}

TEST(WantedObservables, OnlyCostlyOnesAreLeftOut) {
  const auto world = make_world();
  const WorldState state = world->initial_state();
  const std::string costly[] = {"water.divergence.max", "birds.distance.nearest", "birds.groups"};
  const Observables all = world->observe(state);
  for (const std::string& name : costly) EXPECT_TRUE(all.find(name).has_value()) << name << ": control";
  const Observables none = world->observe(state, [](std::string_view) { return false; });
  for (const std::string& name : costly) EXPECT_FALSE(none.find(name).has_value()) << name;
  EXPECT_EQ(none.rows().size() + 3, all.rows().size());
  // Distances that nobody has are not numbers.
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (const Observation& o : none.rows()) {
    EXPECT_TRUE(same(all.find(o.name).value_or(HUGE_VAL), o.value)) << o.name;
  }
  for (const std::string& name : costly) {
    const Observables one = world->observe(state, [&](std::string_view other) { return other == name; });
    EXPECT_TRUE(same(one.find(name).value_or(HUGE_VAL), all.find(name).value_or(-HUGE_VAL))) << name;
  }
}

TEST(WantedObservables, ASeriesHasThoseThatItsSceneNames) {
  const auto names = [](const std::string& more) {
    Session s(make_world(more), std::make_shared<const ThreadArena>(1));
    s.step(2);
    return s.series().names();
  };
  const auto has = [](const std::vector<std::string>& all, std::string_view name) {
    return std::find(all.begin(), all.end(), name) != all.end();
  };
  EXPECT_TRUE(has(names(R"(, "observables": ["water.divergence"])"), "water.divergence.max"));
  EXPECT_FALSE(has(names(""), "water.divergence.max")) << "control";
  EXPECT_TRUE(has(names(""), "water.energy.total"));
}

}  // namespace
}  // namespace truestep
