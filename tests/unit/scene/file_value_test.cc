// Files referred to by scenes: what each becomes, the error for one that is not available, and that no path
// leaves the scene file's folder.
#include "engine/scene/file_value.h"

#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <filesystem>
#include <fstream>

#include "engine/base/errors.h"
#include "engine/scene/file_references.h"

namespace truestep {
namespace {

namespace json = boost::json;
namespace fs = std::filesystem;

const std::string kObj = "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\nf 1 1 2\n";
const std::string kMsh =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 3 \"foot\"\n$EndPhysicalNames\n$Nodes\n4\n1 "
    "0 0 "
    "0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n2\n1 2 1 3 1 2 3\n2 4 1 0 1 2 3 4\n$EndElements\n";

json::value parsed(const char* text) {
  return json::parse(text);
}

TEST(FileValue, IsWhatScenesTakeInItsPlace) {
  EXPECT_EQ(file_value(kObj, FileUse::automatic, 0.5),
            parsed(R"({"vertices": [[0.0,0.0,0.0],[1.0,0.0,0.0],[0.0,1.0,0.0]], "triangles": [0,1,2]})"));
  EXPECT_EQ(file_value(kObj, FileUse::triangles, 1), parsed("[0,1,2]"));
  EXPECT_EQ(file_value(kObj, FileUse::vertices, 1).as_array().size(), 3u);
  const json::value mesh = file_value(kMsh, FileUse::automatic, 1);
  EXPECT_EQ(mesh.at("form"), "tetrahedra");
  EXPECT_EQ(mesh.at("sets"), parsed(R"([{"name": "foot", "points": [0,1,2]}])"));
  EXPECT_EQ(file_value(kMsh, FileUse::surface, 1).at("triangles").as_array().size(), 12u);
  EXPECT_EQ(file_value(R"({"a": [1]})", FileUse::automatic, 1), parsed(R"({"a": [1]})"));
  EXPECT_EQ(file_value("HIERARCHY\r\nROOT a\n", FileUse::automatic, 1), parsed(R"(["HIERARCHY", "ROOT a"])"));
  EXPECT_EQ(file_value("1\n\nAr 0 0 0", FileUse::text, 1), "1\n\nAr 0 0 0");
}

TEST(FileValue, SaysWhyItIsNone) {
  const auto fault = [](std::string_view bytes, FileUse use) -> std::string {
    try {
      file_value(bytes, use, 1);
    } catch (const FileFault& f) {
      return f.what();
    }
    return "";
  };
  EXPECT_EQ(fault(kObj + "f 1 2 4", FileUse::automatic), "line 6: a face has vertex 4, and the file has 3");
  EXPECT_EQ(fault("v 0 0 0", FileUse::automatic), "the file has vertices but no triangles");
  EXPECT_EQ(fault("v 0 0 0", FileUse::vertices), "");
  EXPECT_EQ(fault(kObj, FileUse::cells), "only MSH files have elements: fill the surface of this one");
  EXPECT_EQ(fault("{}", FileUse::surface), "the file is not a mesh: use OBJ, STL, PLY or MSH");
  EXPECT_EQ(fault("hello", FileUse::automatic).substr(0, 36), "the file is none of JSON, OBJ, STL, ");
  EXPECT_EQ(fault("h\xff", FileUse::text), "byte 2: a text must be valid UTF-8");
}

TEST(FileReferences, NoPathLeadsOutOfTheFolder) {
  const fs::path root = fs::temp_directory_path() / ("truestep_files_" + std::to_string(::getpid()));
  fs::create_directories(root / "scene" / "meshes");
  std::ofstream(root / "scene" / "meshes" / "a.obj") << kObj;
  std::ofstream(root / "secret.obj") << kObj;
  fs::create_symlink(root / "secret.obj", root / "scene" / "link.obj");
  const auto issue = [&](const std::string& name) -> std::string {
    json::value v{{"systems", json::array{json::object{{"mesh", json::object{{"path", name}}}}}}};
    try {
      resolve_paths(v, root / "scene");
    } catch (const Error& e) {
      EXPECT_EQ(e.issues().at(0).pointer, "/systems/0/mesh/path");
      return e.issues().at(0).message;
    }
    EXPECT_TRUE(v.at("systems").at(0).at("mesh").is_object());
    EXPECT_TRUE(v.at("systems").at(0).at("mesh").as_object().contains("triangles"));
    return "";
  };
  EXPECT_EQ(issue("meshes/a.obj"), "");
  EXPECT_EQ(issue("meshes/b.obj"), "there is no such file");
  EXPECT_EQ(issue("meshes"), "there is no such file");
  const std::string out = "a path must lead to a file in the scene file's folder or below it";
  for (const std::string& name : {std::string("../secret.obj"), std::string("meshes/../../secret.obj"),
                                  (root / "secret.obj").string(), std::string("link.obj"), std::string()}) {
    EXPECT_EQ(issue(name), out) << name;
  }
  fs::remove_all(root);
}

TEST(FileReferences, ObjectsWithOtherMembersAreNone) {
  json::value v =
      parsed(R"({"a": {"path": "x", "speed": 1}, "b": {"path": 3}, "c": [[1, 2], {"path": [0]}]})");
  const json::value before = v;
  resolve_paths(v, ".");
  EXPECT_EQ(v, before);
}

}  // namespace
}  // namespace truestep
