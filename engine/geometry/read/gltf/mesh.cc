#include "engine/geometry/read/gltf/mesh.h"

#include <algorithm>
#include <array>

namespace truestep::gltf {

namespace {

void read_weights(const Value& attributes, const Buffers& buffers, size_t count, size_t first,
                  GltfMesh& mesh) {
  const Value joints = attributes.member("JOINTS_0"), weights = attributes.member("WEIGHTS_0");
  if (!joints.there()) {
    if (!mesh.joints.empty()) fail(attributes.where(), "a primitive of the mesh has no JOINTS_0");
    return;
  }
  if (mesh.joints.size() != first) fail(attributes.where(), "a primitive of the mesh has no JOINTS_0");
  const std::vector<double> j = buffers.numbers(joints, 4, false), w = buffers.numbers(weights, 4, true);
  if (j.size() != 4 * count || w.size() != 4 * count)
    fail(joints.where(), "must have as many as there are positions");
  for (size_t k = 0; k < count; ++k) {
    std::array<uint32_t, 4> joint;
    std::array<double, 4> weight;
    double sum = 0;
    for (size_t i = 0; i < 4; ++i) {
      if (!(j[4 * k + i] >= 0)) fail(joints.where(), "element " + std::to_string(k) + " is negative");
      joint[i] = static_cast<uint32_t>(j[4 * k + i]), weight[i] = std::max(w[4 * k + i], 0.0),
      sum += weight[i];
    }
    if (!(sum > 0)) weight = {1, 0, 0, 0}, sum = 1;
    for (double& x : weight) x /= sum;
    mesh.joints.push_back(joint), mesh.weights.push_back(weight);
  }
}

}  // namespace

GltfMesh read_mesh(const Value& v, const Buffers& buffers) {
  GltfMesh mesh;
  mesh.name = v.member("name").text_or("");
  const Value names =
      v.member("extras").there() ? v.member("extras").member("targetNames") : Value(nullptr, "");
  for (size_t k = 0; k < names.size(); ++k) mesh.target_names.push_back(names[k].text_or(""));
  const Value primitives = v.member("primitives");
  for (size_t p = 0; p < primitives.size(); ++p) {
    const Value primitive = primitives[p];
    if (primitive.member("mode").number_or(4) != 4)
      fail(primitive.where() + "/mode", "only triangles are read");
    if (primitive.member("extensions").there())
      fail(primitive.where() + "/extensions", "compressed meshes are not read");
    const Value attributes = primitive.member("attributes");
    const std::vector<Vec3> places = buffers.vectors(attributes.member("POSITION"));
    const size_t first = mesh.positions.size();
    mesh.positions.insert(mesh.positions.end(), places.begin(), places.end());
    std::vector<double> indices;
    if (primitive.member("indices").there()) {
      indices = buffers.numbers(primitive.member("indices"), 1, false);
    } else {
      for (size_t k = 0; k < places.size(); ++k) indices.push_back(static_cast<double>(k));
    }
    if (indices.size() % 3 != 0) fail(primitive.where() + "/indices", "must have three per triangle");
    for (size_t k = 0; k < indices.size(); k += 3) {
      std::array<uint32_t, 3> t;
      for (size_t i = 0; i < 3; ++i) {
        if (!(indices[k + i] >= 0 && indices[k + i] < static_cast<double>(places.size()))) {
          fail(primitive.where() + "/indices", "element " + std::to_string(k + i) + " is not a vertex");
        }
        t[i] = static_cast<uint32_t>(first + static_cast<size_t>(indices[k + i]));
      }
      mesh.triangles.push_back(t);
    }
    read_weights(attributes, buffers, places.size(), first, mesh);
    const Value targets = primitive.member("targets");
    if (p > 0 && targets.size() != mesh.targets.size())
      fail(targets.where(), "must have as many as in the first primitive");
    mesh.targets.resize(targets.size());
    for (size_t k = 0; k < targets.size(); ++k) {
      mesh.targets[k].resize(first);
      std::vector<Vec3> offsets(places.size());
      if (targets[k].member("POSITION").there()) offsets = buffers.vectors(targets[k].member("POSITION"));
      if (offsets.size() != places.size()) fail(targets[k].where(), "must have as many vertices as the base");
      mesh.targets[k].insert(mesh.targets[k].end(), offsets.begin(), offsets.end());
    }
  }
  if (!mesh.target_names.empty() && mesh.target_names.size() != mesh.targets.size())
    mesh.target_names.clear();
  return mesh;
}

}  // namespace truestep::gltf
