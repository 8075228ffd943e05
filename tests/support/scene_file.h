// Scenes of tests/scenes for tests that look at more of them than `truestep check` does.
#pragma once
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"

namespace truestep::testing {

/// The scene tests/scenes/<name>.json without its test; a failure and an empty object when there is none.
inline boost::json::object scene_file(const std::string& name) {
  std::ifstream file(TRUESTEP_SOURCE_DIR "/tests/scenes/" + name + ".json");
  EXPECT_TRUE(file.good()) << name;
  if (!file) return {};
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  boost::json::object scene = parse_json(text).as_object();
  scene.erase("test");
  scene.erase("expect");
  return scene;
}

}  // namespace truestep::testing
