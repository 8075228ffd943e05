// Base and targets of blend shapes from OBJ, PLY and glTF files: the same surface as from lists, and errors
// with their pointer.
#include <boost/json.hpp>

#include "engine/base/errors.h"
#include "engine/scene/file_value.h"
#include "engine/sinks/motion/motion_export.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

namespace json = boost::json;

constexpr const char* kBaseObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n";
constexpr const char* kWideObj = "v 0 0 0\nv 1.5 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n";
constexpr const char* kTallPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\nend_header\n"
    "0 0 0\n1 0 0\n0 2 0\n0 0 1\n";
constexpr const char* kShortPly =
    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
    "z\nend_header\n"
    "0 0 0\n";

std::string scene(const std::string& members) {
  return R"({"time": {"dt": 0.02}, "systems": [{"type": "blend_shapes", "id": "face", )" + members + "}]}";
}
std::string value(const std::string& bytes, FileUse use) {
  return json::serialize(file_value(bytes, use, 1));
}
/// Where vertices are after 20 steps, with weights t and 2 t.
std::vector<double> blended(const std::string& text) {
  testing_coupled::SceneRun run(text);
  run.session.step(20);
  const State& s = run.session.state().systems[0];
  const auto x = s.f64(s.at("position"));
  return {x.begin(), x.end()};
}
const std::string kLists = scene(
    R"("vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "triangles": [0,1,2, 0,2,3],
       "targets": [{"name": "wide", "weight": "t", "vertices": [[0,0,0],[1.5,0,0],[0,1,0],[0,0,1]]},
                   {"name": "tall", "weight": "2*t", "vertices": [[0,0,0],[1,0,0],[0,2,0],[0,0,1]]}])");
/// A .glb of that surface with its targets.
std::string glb() {
  testing_coupled::SceneRun run(kLists);
  MotionExport file(run.world->system(0), "face", 50);
  file.add(run.session.state().systems[0], 0);
  return file.glb();
}
std::string gltf() {
  testing_coupled::SceneRun run(kLists);
  MotionExport file(run.world->system(0), "face", 50);
  file.add(run.session.state().systems[0], 0);
  return file.gltf();
}

TEST(ShapeFiles, ObjAndPlyAreBaseAndTargets) {
  const std::vector<double> want = blended(kLists);
  ASSERT_NEAR(want[3], 1 + 0.4 * 0.5, 1e-15) << "the control: x of vertex 1";
  const std::string files = scene(
      R"("vertices": )" + value(kBaseObj, FileUse::vertices) + R"(, "triangles": )" +
      value(kBaseObj, FileUse::triangles) + R"(, "targets": [{"name": "wide", "weight": "t", "vertices": )" +
      value(kWideObj, FileUse::vertices) + R"(}, {"name": "tall", "weight": "2*t", "vertices": )" +
      value(kTallPly, FileUse::vertices) + "}]");
  EXPECT_EQ(blended(files), want);
  const std::string ply_base = scene(R"("vertices": )" + value(kTallPly, FileUse::vertices) +
                                     R"(, "targets": [{"name": "w", "weight": "t", "vertices": )" +
                                     value(kWideObj, FileUse::vertices) + "}]");
  EXPECT_NEAR(blended(ply_base)[7], 2 - 0.4, 1e-15);
}

TEST(ShapeFiles, AGltfIsBaseWithItsTargetsAndATarget) {
  const std::vector<double> want = blended(kLists);
  for (const std::string& lines : {value(glb(), FileUse::automatic), value(gltf(), FileUse::gltf)}) {
    // 0.5, 1, 1.5 and 2 are exact in f32.
    EXPECT_EQ(blended(scene(
                  R"("gltf": )" + lines +
                  R"(, "targets": [{"name": "wide", "weight": "t"}, {"name": "tall", "weight": "2*t"}])")),
              want);
    EXPECT_EQ(blended(scene(R"("gltf": )" + lines +
                            R"(, "mesh": "face", "targets": [{"name": "wide", "weight": "t"},
                               {"name": "tall", "weight": "2*t", "vertices": )" +
                            value(kTallPly, FileUse::vertices) + "}]")),
              want)
        << "lists and files beside each other";
    const std::vector<double> back =
        blended(scene(R"("vertices": )" + value(kTallPly, FileUse::vertices) +
                      R"(, "targets": [{"name": "rest", "weight": "t", "gltf": )" + lines + "}]"));
    EXPECT_NEAR(back[7], 2 - 0.4, 1e-15) << "the file's mesh as a target";
  }
}

TEST(ShapeFiles, WhatDoesNotFitIsSaidWhereItIs) {
  const auto fault = [](const std::string& text) {
    try {
      testing_coupled::SceneRun run(text);
    } catch (const Error& e) {
      return e.issues().empty() ? std::string() : e.issues()[0].pointer + " " + e.issues()[0].allowed;
    }
    return std::string("fits");
  };
  const std::string lines = value(glb(), FileUse::automatic), at = "/systems/0";
  EXPECT_EQ(fault(scene(R"("gltf": )" + lines + R"(, "mesh": "nose")")), at + "/mesh face");
  EXPECT_EQ(fault(scene(R"("gltf": )" + lines + R"(, "targets": [{"name": "sad", "weight": "1"}])")),
            at + "/targets/0/name wide, tall");
  EXPECT_EQ(fault(scene(R"("gltf": )" + lines + R"(, "targets": [{"name": "a", "weight": "1", "vertices": )" +
                        value(kShortPly, FileUse::vertices) + "}]")),
            at + "/targets/0/vertices 4");
  EXPECT_EQ(fault(scene(R"("vertices": [[0,0,0]], "targets": [{"name": "a", "weight": "1", "gltf": )" +
                        lines + "}]")),
            at + "/targets/0/gltf 1");
  EXPECT_EQ(fault(scene(R"("vertices": [[0,0,0]], "targets": [{"name": "a", "weight": "1", "vertices": )" +
                        value(kTallPly, FileUse::vertices) + "}]")),
            at + "/targets/0/vertices ");
  EXPECT_EQ(fault(scene(R"("vertices": [[0,0,0]], "targets": [{"name": "a", "weight": "1"}])")),
            at + "/targets/0 ");
  EXPECT_EQ(fault(scene(R"("gltf": ["glTF nonsense"])")), at + "/gltf ");
  EXPECT_EQ(fault(scene(R"("gltf": )" + lines + R"(, "vertices": [[0,0,0]])")), at + " ");
  EXPECT_THROW(file_value(kBaseObj, FileUse::gltf, 1), FileFault);
  EXPECT_THROW(file_value("{\"asset\": \"\xff\"}", FileUse::gltf, 1), FileFault);
}

}  // namespace
}  // namespace truestep
