#include "engine/systems/blend_shapes/shape_files.h"

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/geometry/read/gltf.h"

namespace truestep::blend_shapes {

namespace {

[[noreturn]] void refuse(const std::string& pointer, const std::string& code, const std::string& why,
                         const std::string& value, const std::string& allowed) {
  throw Error("scene_invalid", why, {pointer, code, why, value, allowed, "", ""});
}

std::string listed(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& n : names) all += (all.empty() ? "" : ", ") + (n.empty() ? "(no name)" : n);
  return all.empty() ? "there are none" : all;
}

/// The mesh of this name; without a name, the first one.
GltfMesh mesh_of(const std::vector<std::string>& lines, const std::string& name, const std::string& at) {
  GltfModel model;
  std::vector<std::string> names;
  try {
    model = read_gltf(lines);
    for (GltfMesh& mesh : model.meshes) {
      names.push_back(mesh.name);
      if (!name.empty() && mesh.name != name) continue;
      require_sound(mesh.fault);
      return std::move(mesh);
    }
  } catch (const GltfFault& f) {
    refuse(at + "/gltf", "bad_gltf", f.what(), "", "");
  }
  if (name.empty()) refuse(at + "/gltf", "bad_gltf", "the file has no mesh", "", "");
  refuse(at + "/mesh", "unknown_name", "the file has no mesh \"" + name + '"', name, listed(names));
}

}  // namespace

BlendShapesDef with_files(const BlendShapesDef& given) {
  BlendShapesDef def = given;
  GltfMesh base;
  if (!def.gltf.empty()) {
    base = mesh_of(def.gltf, def.mesh, "");
    def.vertices = base.positions;
    for (const auto& t : base.triangles) def.triangles.insert(def.triangles.end(), t.begin(), t.end());
    def.gltf.clear();
    for (size_t k = base.target_names.size(); k < base.targets.size(); ++k)
      base.target_names.push_back(std::to_string(k));
  }
  const size_t want = def.ball
                          ? 2 + static_cast<size_t>(def.ball->rings) * static_cast<size_t>(def.ball->around)
                          : def.vertices.size();
  for (size_t k = 0; k < def.targets.size(); ++k) {
    TargetDef& t = def.targets[k];
    const std::string at = "/targets/" + std::to_string(k);
    if (!t.gltf.empty()) {
      t.vertices = mesh_of(t.gltf, t.mesh, at).positions;
      t.gltf.clear();
      if (t.vertices.size() != want) {
        refuse(at + "/gltf", "wrong_count", "a target needs as many vertices as the base",
               std::to_string(t.vertices.size()), std::to_string(want));
      }
    } else if (t.vertices.empty() && t.offset.empty()) {
      const auto found = std::ranges::find(base.target_names, t.name);
      if (found == base.target_names.end()) {
        refuse(at + "/name", "unknown_name", "the file has no target \"" + t.name + '"', t.name,
               listed(base.target_names));
      }
      const auto& offsets = base.targets[static_cast<size_t>(found - base.target_names.begin())];
      for (size_t i = 0; i < want; ++i) t.vertices.push_back(base.positions[i] + offsets[i]);
    } else if (!t.vertices.empty() && t.vertices.size() != want) {
      refuse(at + "/vertices", "wrong_count", "a target needs as many vertices as the base",
             std::to_string(t.vertices.size()), std::to_string(want));
    }
  }
  return def;
}

}  // namespace truestep::blend_shapes
