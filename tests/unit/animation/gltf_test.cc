// glTF export and import: the motion of a skeleton and a blended surface is written, read back and compared;
// and errors in a file are reported with their place.
#include "engine/geometry/read/gltf.h"

#include <cmath>

#include "engine/base/errors.h"
#include "engine/geometry/read/bvh.h"
#include "engine/scene/scene.h"
#include "engine/session/session.h"
#include "engine/sinks/motion/motion_export.h"
#include "engine/systems/skeleton/recording.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

constexpr const char* kArm = R"scene({"time": {"dt": 0.02}, "systems": [
    {"type": "skeleton", "id": "arm", "root_position": ["0.3*t", "1", "0"], "joints": [
      {"id": "a", "rest_rotation": [0, 0, 0.4], "rotation": ["0.5*sin(3*t)", "0.2", "2*t"]},
      {"id": "b", "parent": "a", "offset": [0.5, 0, 0], "type": "revolute", "axis": [0, 1, 0], "value": "sin(4*t)"},
      {"id": "c", "parent": "b", "offset": [0.4, 0, 0.1], "type": "prismatic", "axis": [1, 0, 0], "value": "0.1*sin(5*t)", "end": [0.3, 0, 0]}],
     "skin": {"tubes": [{"from": "a", "to": "c", "radius": 0.08, "rings": 6, "around": 5}], "method": "linear"}}]})scene";

struct Exported {
  testing_coupled::SceneRun run;
  MotionExport file;
  std::vector<std::vector<Vec3>> joints, skins;
  explicit Exported(const std::string& scene, int frames = 26)
      : run(scene), file(run.world->system(0), "arm", 50) {
    for (int f = 0; f < frames; ++f) {
      if (f > 0) run.session.step(1);
      const State& s = run.session.state().systems[0];
      file.add(s, run.session.time());
      if (const auto j = s.find("position")) joints.push_back(rows(s, *j));
      if (const auto k = s.find("skin.position")) skins.push_back(rows(s, *k));
    }
  }
  static std::vector<Vec3> rows(const State& s, State::Column c) {
    std::vector<Vec3> out;
    for (size_t k = 0; k < s.rows(c); ++k) out.push_back(load3(s.f64(c).data(), k));
    return out;
  }
};

std::string in_scene(const std::string& member, const std::string& text, const std::string& more = "") {
  boost::json::array lines;
  size_t at = 0;
  while (at < text.size()) {
    // A member that is not split into lines may be broken anywhere.
    const bool whole = member == "gltf";
    const size_t end = whole ? std::min(at + 3000, text.size()) : std::min(text.find('\n', at), text.size());
    lines.push_back(boost::json::string(text.substr(at, end - at)));
    at = whole ? end : end + 1;
  }
  return R"({"time": {"dt": 0.02}, "systems": [{"type": "motion_capture", "id": "arm", "motion": {")" +
         member + "\": " + boost::json::serialize(lines) + (member == "gltf" ? ", \"rate\": 50" : "") + "}" +
         more + "}]}";
}

double farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0;
  for (size_t k = 0; k < std::min(a.size(), b.size()); ++k) most = std::max(most, norm(a[k] - b[k]));
  return most;
}

TEST(GltfExport, ASkeletonWithItsSkinComesBack) {
  const Exported out(kArm);
  testing_coupled::SceneRun back(
      in_scene("gltf", out.file.gltf(), R"(, "skin": {"source": "motion_file", "method": "linear"})"));
  for (size_t f = 0; f < out.joints.size(); ++f) {
    if (f > 0) back.session.step(1);
    const State& s = back.session.state().systems[0];
    // f32 in the file: 6e-8 of a metre or of a radian in every joint of the chain.
    ASSERT_LT(farthest(out.joints[f], Exported::rows(s, s.at("position"))), 1e-6) << f;
    ASSERT_LT(farthest(out.skins[f], Exported::rows(s, s.at("skin.position"))), 2e-6) << f;
  }
  EXPECT_GT(farthest(out.skins[0], out.skins[20]), 0.1) << "the control: it moves";
}

TEST(GltfExport, GlbAndGltfAreTheSame) {
  const Exported out(kArm, 5);
  const std::string glb = out.file.glb(), gltf = out.file.gltf();
  const GltfModel a = read_gltf(std::as_bytes(std::span(glb))), b = read_gltf(std::as_bytes(std::span(gltf)));
  ASSERT_EQ(a.nodes.size(), 4u);
  ASSERT_EQ(a.meshes.size(), 1u);
  EXPECT_EQ(a.meshes[0].positions.size(), b.meshes[0].positions.size());
  ASSERT_EQ(a.animations.size(), 1u);
  for (size_t c = 0; c < a.animations[0].channels.size(); ++c)
    EXPECT_EQ(a.animations[0].channels[c].values, b.animations[0].channels[c].values);
}

TEST(GltfExport, TargetsAndTheirWeightsComeBack) {
  const Exported out(R"scene({"time": {"dt": 0.02}, "systems": [{"type": "blend_shapes", "id": "face",
      "vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "triangles": [0,1,2, 0,2,3],
      "targets": [{"name": "wide", "weight": "sin(t)", "offset": ["0.5*x", "0", "0"]},
                  {"name": "tall", "weight": "t", "vertices": [[0,0,0],[1,0,0],[0,2,0],[0,0,1]]}]}]})scene");
  const std::string file = out.file.glb();
  const GltfModel m = read_gltf(std::as_bytes(std::span(file)));
  ASSERT_EQ(m.meshes.size(), 1u);
  EXPECT_EQ(m.meshes[0].target_names, (std::vector<std::string>{"wide", "tall"}));
  ASSERT_EQ(m.meshes[0].targets.size(), 2u);
  EXPECT_EQ(m.meshes[0].targets[0][1].x, 0.5);
  EXPECT_EQ(m.meshes[0].targets[1][2].y, 1);
  for (const GltfChannel& c : m.animations[0].channels) {
    if (c.path != GltfChannel::Path::weights) continue;
    ASSERT_EQ(c.width, 2u);
    EXPECT_NEAR(c.values[2 * 25], std::sin(0.5), 1e-7);
    EXPECT_NEAR(c.values[2 * 25 + 1], 0.5, 1e-7);
  }
}

TEST(BvhExport, ASkeletonComesBack) {
  const Exported out(kArm);
  testing_coupled::SceneRun back(in_scene("bvh", out.file.bvh()));
  for (size_t f = 0; f < out.joints.size(); ++f) {
    if (f > 0) back.session.step(1);
    const State& s = back.session.state().systems[0];
    // Angles go through degrees and back: rounding.
    ASSERT_LT(farthest(out.joints[f], Exported::rows(s, s.at("position"))), 1e-12) << f;
  }
}

/// Of the file, or the first one of what is in it.
std::string fault_of(const std::string& text) {
  try {
    const GltfModel m = read_gltf(std::as_bytes(std::span(text)));
    for (const GltfNode& n : m.nodes) require_sound(n.fault);
    for (const GltfMesh& mesh : m.meshes) require_sound(mesh.fault);
    for (const GltfAnimation& a : m.animations) require_sound(a.fault);
  } catch (const GltfFault& f) {
    return f.what();
  }
  return "";
}
std::string document(const std::string& more) {
  return R"({"asset": {"version": "2.0"}, )" + more + "}";
}

TEST(Gltf, FaultsSayWhereTheyAre) {
  const auto begins = [](const std::string& text, const std::string& with) {
    const std::string fault = fault_of(text);
    EXPECT_TRUE(fault.starts_with(with)) << fault << " instead of " << with;
  };
  begins("{\"asset\": ", "byte ");
  begins("{\"asset\": {\"version\": \"2.0\"}, x", "byte 30");
  begins("{}", "/asset/version");
  begins(document(R"("nodes": [{"children": [1]}, {"children": [0]}])"), "/nodes/0: is its own ancestor");
  begins(document(R"("nodes": [{"children": [0]}])"), "/nodes/0: is its own ancestor");
  begins(document(R"("nodes": [{"children": [7]}])"), "/nodes/0/children/0");
  begins(document(R"("nodes": [{}, {"children": [0]}, {"children": [0]}])"), "/nodes/2/children/0");
  begins(document(R"("nodes": [{"scale": [1, 2, 1]}])"), "/nodes/0/scale");
  begins(document(R"("nodes": [{"translation": [1e300, 0, 0]}])"), "/nodes/0/translation/0");
  begins(document(R"("nodes": [{"rotation": [0, 0, 0, 0]}])"), "/nodes/0/rotation");
  begins(document(R"("nodes": [{"mesh": 0}])"), "/nodes/0/mesh");
  const std::string triangle =
      R"("bufferViews": [{"buffer": 0, "byteLength": 36}], "accessors": [{"bufferView": 0, "componentType": 5126, )"
      R"("count": 3, "type": "VEC3"}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], )";
  begins(document(triangle + R"("buffers": [{"uri": "mesh.bin", "byteLength": 4}])"), "/buffers/0/uri");
  begins(document(triangle + R"("buffers": [{"uri": "data:x;base64,AAAA", "byteLength": 4}])"),
         "/buffers/0/byteLength");
  begins(document(triangle + R"("buffers": [{"uri": "data:x;base64,A*AA", "byteLength": 2}])"),
         "/buffers/0/uri: byte 1");
  EXPECT_EQ(fault_of(document(R"("buffers": [{"uri": "unused.bin", "byteLength": 4}])")), "");
  const std::string buffer = R"("buffers": [{"uri": "data:x;base64,AAAAAAAAAAAAAAAA", "byteLength": 12}], )";
  const std::string mesh = R"(, "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}])";
  const auto accessor = [&](const std::string& a, const std::string& view) {
    return document(buffer + "\"bufferViews\": [" + view + "], \"accessors\": [" + a + "]" + mesh);
  };
  const std::string view = R"({"buffer": 0, "byteLength": 12})";
  begins(accessor(R"({"bufferView": 0, "componentType": 5126, "count": 2, "type": "VEC3"})", view),
         "/accessors/0: reaches beyond");
  begins(accessor(R"({"bufferView": 0, "componentType": 5126, "count": 1e11, "type": "VEC3"})", view),
         "/accessors/0: reaches beyond");
  begins(accessor(R"({"bufferView": 0, "componentType": 5126, "count": 1.5, "type": "VEC3"})", view),
         "/accessors/0/count");
  begins(accessor(R"({"bufferView": 0, "componentType": 5126, "count": 1, "type": "VEC2"})", view),
         "/accessors/0/type");
  begins(accessor(R"({"bufferView": 0, "componentType": 7, "count": 1, "type": "VEC3"})", view),
         "/accessors/0/componentType");
  begins(accessor(R"({"bufferView": 3, "componentType": 5126, "count": 1, "type": "VEC3"})", view),
         "/accessors/0/bufferView");
  begins(accessor(R"({"bufferView": 0, "componentType": 5126, "count": 1, "type": "VEC3"})",
                  R"({"buffer": 0, "byteLength": 99})"),
         "/bufferViews/0");
  EXPECT_EQ(
      fault_of(accessor(R"({"bufferView": 0, "componentType": 5126, "count": 1, "type": "VEC3"})", view))
          .substr(0, 31),
      "/meshes/0/primitives/0/indices:")
      << "one vertex is no triangle";
  std::string glb = Exported(kArm, 2).file.glb();
  EXPECT_EQ(fault_of(glb), "");
  begins(glb.substr(0, glb.size() - 5), "byte 8");
  std::string longer = glb;
  longer[13] = '\x7f';
  begins(longer, "byte 12");
  std::string version = glb;
  version[4] = 1;
  begins(version, "byte 4");
}

TEST(Gltf, AFaultInASceneHasItsPointer) {
  try {
    testing_coupled::SceneRun run(in_scene("gltf", "{\"asset\": {\"version\": \"2.0\"}}"));
    FAIL();
  } catch (const Error& e) {
    ASSERT_FALSE(e.issues().empty());
    EXPECT_EQ(e.issues()[0].pointer, "/systems/0/motion/gltf");
  }
}

TEST(Gltf, KeysAreReadAsTheFileSays) {
  // Two seconds, two keys: x from 1 to 3 by step, linearly and by a cubic with slopes 0.
  const auto at = [](const std::string& between, double t) {
    GltfModel m;
    GltfNode node;
    node.name = "n";
    m.nodes.push_back(node);
    GltfChannel c;
    using B = GltfChannel::Between;
    c.between = between == "step" ? B::step : between == "cubic" ? B::cubic : B::linear;
    c.times = {0, 2};
    c.values = between == "cubic" ? std::vector<double>{0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0}
                                  : std::vector<double>{1, 0, 0, 3, 0, 0};
    m.animations.push_back({"a", {c}});
    const auto r = skeleton::recording_of(m, "a", 4);
    return r.joints[0].offset.x + r.shifts[static_cast<size_t>(t * 4)].x;
  };
  EXPECT_EQ(at("step", 1.75), 1);
  EXPECT_EQ(at("step", 2), 3);
  EXPECT_NEAR(at("linear", 0.5), 1.5, 1e-15);
  EXPECT_NEAR(at("cubic", 0.5), 1 + 2 * (3 * 0.0625 - 2 * 0.015625), 1e-15);
}

}  // namespace
}  // namespace truestep
