#include <gtest/gtest.h>

#include "engine/scene/json/json.h"
#include "engine/scene/params/params.h"
#include "engine/session/world/world.h"

namespace truestep {
namespace {

constexpr const char* kSystems = R"("systems": [
  {"type": "mass_spring", "id": "cloth", "cloth_grid": {"nx": 3, "ny": 3}},
  {"type": "particles", "id": "dust", "positions": [[0, 1, 0]]},
  {"type": "pendulum", "id": "clock"}])";

std::string scene(const std::string& couplings) {
  return std::string("{") + kSystems + R"(, "couplings": )" + couplings + "}";
}

TEST(CouplingScene, CanonicalFormReadsBackAsTheSame) {
  const Scene first = parse_scene(scene(R"([{"type": "attachment", "a": "cloth", "b": "dust",
    "rest_length": "20 cm"}])"));
  const auto written = first.canonical();
  const SceneReport again = read_scene(written);
  ASSERT_TRUE(again.scene) << (again.errors.empty() ? "" : again.errors[0].pointer);
  EXPECT_EQ(again.scene->canonical(), written);
  EXPECT_EQ(written.at("couplings").at(0).at("rest_length").as_double(), 0.2);
  EXPECT_EQ(written.at("couplings").at(0).at("id").as_string(), "attachment0");
}

TEST(CouplingScene, SchemaAndPlanNameWhatThereIs) {
  const auto schema = scene_schema();
  const auto& kinds = schema.at("properties").at("couplings").at("items").at("oneOf").as_array();
  ASSERT_EQ(kinds.size(), coupling_catalogue().size());
  for (size_t i = 0; i < kinds.size(); ++i) {
    EXPECT_EQ(kinds[i].at("properties").at("type").at("const").as_string(), coupling_catalogue()[i].type);
  }
  const World coupled(parse_scene(scene(R"([{"type": "attachment", "a": "cloth", "b": "dust"}])")));
  const World alone(parse_scene(scene("[]")));
  size_t rows = 0;
  for (const World::PlanEntry& e : coupled.plan()) {
    if (e.system != "attachment0") continue;
    EXPECT_EQ(e.profile, 3u);
    ++rows;
  }
  EXPECT_EQ(rows, 2u);
  EXPECT_EQ(alone.plan().back().row.name, "couplings");
  EXPECT_EQ(alone.plan().back().row.status, PlanRow::Status::skipped);
}

}  // namespace
}  // namespace truestep
