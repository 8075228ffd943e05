// A box may be given in the words of any other system: it is the same box, and is written in the table's own.
// (Two boxes for one are refused: tests/scenes/refused/boxes.json.)
#include <gtest/gtest.h>

#include "engine/scene/json/json.h"
#include "engine/scene/params/params.h"
#include "engine/scene/scene.h"

namespace truestep {
namespace {

struct Spelling {
  const char *own, *other;
};

std::string system_text(const char* members) {
  return std::string(R"({"schema_version": "1.0", "time": {"dt": 0.001, "duration": 0.01}, "systems": [)") +
         members + "]}";
}
boost::json::value echo(const char* members) {
  const Scene scene = parse_scene(system_text(members));
  return write_params(*scene.systems[0].row->table, scene.systems[0].def.get());
}

class BoxWords : public testing::TestWithParam<Spelling> {};

TEST_P(BoxWords, AreReadAndEchoedAsTheTablesOwn) {
  EXPECT_EQ(echo(GetParam().other), echo(GetParam().own));
}

INSTANTIATE_TEST_SUITE_P(
    Spellings, BoxWords,
    testing::Values(
        Spelling{
            R"({"type": "rigid3d", "id": "a", "bodies": [{"type": "box", "half_extents": [1, 2, 0.5]}]})",
            R"({"type": "rigid3d", "id": "a", "bodies": [{"type": "box", "size": [2, "400 cm", 1]}]})"},
        Spelling{
            R"({"type": "rigid3d", "id": "a", "bodies": [{"type": "box", "position": [1, 1, 1], "half_extents": [1, 1, 1]}]})",
            R"({"type": "rigid3d", "id": "a", "bodies": [{"type": "box", "low": [0, 0, 0], "high": [2, 2, 2]}]})"},
        Spelling{
            R"({"type": "rigid3d", "id": "a", "bodies": [{"type": "box", "position": [1, 1, 1], "half_extents": [1, 1, 1]}]})",
            R"({"type": "rigid3d", "id": "a", "bodies": [{"type": "box", "position": [1, 1, 1], "size": 2}]})"},
        Spelling{
            R"({"type": "sph", "id": "a", "low": [-1, -1, -1], "high": [1, 3, 1], "spacing": 0.25, "bodies": [{"center": [0, 0.5, 0], "half_extents": [0.5, 0.5, 0.5]}]})",
            R"({"type": "sph", "id": "a", "center": [0, 1, 0], "half_extents": [1, 2, 1], "spacing": 0.25, "bodies": [{"low": [-0.5, 0, -0.5], "high": [0.5, 1, 0.5]}]})"},
        Spelling{
            R"({"type": "grid_fluid", "id": "a", "cells": [8, 8], "size": [2, 1], "origin": [-1, 0, 0]})",
            R"({"type": "grid_fluid", "id": "a", "cells": [8, 8], "low": [-1, 0], "high": [1, 1]})"},
        Spelling{R"({"type": "grid_fluid", "id": "a", "cells": [8, 8], "size": [2, 1]})",
                 R"({"type": "grid_fluid", "id": "a", "cells": [8, 8], "half_extents": [1, 0.5]})"}));

}  // namespace
}  // namespace truestep
