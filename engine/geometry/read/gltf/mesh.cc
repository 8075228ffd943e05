#include "engine/geometry/read/gltf/mesh.h"

#include <algorithm>
#include <array>
#include <optional>

#include "engine/geometry/read/gltf/extensions.h"

namespace truestep::gltf {

namespace {

/// Up to eight joints a vertex; the four with the largest weights are kept and share what the others had.
void read_weights(const Value& attributes, const Buffers& buffers, size_t count, size_t first,
                  GltfMesh& mesh) {
  const Value joints = attributes.member("JOINTS_0");
  if (joints.there() ? mesh.joints.size() != first : !mesh.joints.empty())
    fail(attributes.where(), "a primitive of the mesh has no JOINTS_0");
  if (!joints.there()) return;
  std::vector<std::vector<std::pair<double, uint32_t>>> all(count);  // weight, joint
  for (const char* set : {"0", "1"}) {
    const Value j = attributes.member(std::string("JOINTS_") + set);
    if (!j.there()) continue;
    const std::vector<double> of = buffers.numbers(j, 4);
    const std::vector<double> w = buffers.numbers(attributes.member(std::string("WEIGHTS_") + set), 4);
    if (of.size() != 4 * count || w.size() != 4 * count)
      fail(j.where(), "must have as many as there are positions");
    for (size_t k = 0; k < of.size(); ++k) {
      if (!(of[k] >= 0 && of[k] < 65536) || of[k] != std::floor(of[k]))
        fail(j.where(), "element " + std::to_string(k / 4) + " is not the index of a joint");
      all[k / 4].emplace_back(std::max(w[k], 0.0), static_cast<uint32_t>(of[k]));
    }
  }
  for (auto& of : all) {
    std::ranges::stable_sort(of, std::greater{}, [](const auto& p) { return p.first; });
    std::array<uint32_t, 4> joint;
    std::array<double, 4> weight;
    double sum = 0;
    for (size_t i = 0; i < 4; ++i) weight[i] = of[i].first, joint[i] = of[i].second, sum += weight[i];
    if (!(sum > 0)) weight = {1, 0, 0, 0}, sum = 1;
    for (double& x : weight) x /= sum;
    mesh.joints.push_back(joint), mesh.weights.push_back(weight);
  }
}

/// Corners of triangles, three each, of a list, a strip or a fan of them; nothing of points and lines.
std::optional<std::vector<size_t>> corners_of(const Value& mode, const std::vector<double>& indices,
                                              const Value& where) {
  const double kind = mode.number_or(4);
  if (!(kind >= 0 && kind <= 6) || kind != std::floor(kind)) fail(mode.where(), "must be 0 to 6");
  if (kind < 4) return std::nullopt;
  const size_t n = indices.size();
  if (kind == 4 && n % 3 != 0) fail(where.where(), "must have three per triangle");
  std::vector<size_t> out;
  if (kind == 4) {
    for (size_t k = 0; k < n; ++k) out.push_back(k);
  }
  for (size_t k = 0; kind > 4 && k + 2 < n; ++k) {
    // Every second triangle of a strip runs backwards.
    const size_t odd = kind == 5 ? k % 2 : 0;
    for (const size_t c :
         {kind == 5 ? k : k + 1, k + 1 + (kind == 5 ? odd : 1), kind == 5 ? k + 2 - odd : size_t{0}})
      out.push_back(c);
  }
  return out;
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
    if (const std::string_view by = compression_of(primitive); !by.empty()) {
      const Value position = primitive.member("attributes").member("POSITION");
      if (!position.there() || !buffers.has_data(position))
        fail(primitive.where() + "/extensions/" + std::string(by), "compressed meshes are not read");
    }
    const Value attributes = primitive.member("attributes");
    const std::vector<Vec3> places = buffers.vectors(attributes.member("POSITION"));
    std::vector<double> indices;
    if (primitive.member("indices").there()) {
      indices = buffers.numbers(primitive.member("indices"), 1);
    } else {
      for (size_t k = 0; k < places.size(); ++k) indices.push_back(static_cast<double>(k));
    }
    for (size_t k = 0; k < indices.size(); ++k) {
      if (indices[k] >= 0 && indices[k] < static_cast<double>(places.size())) continue;
      fail(primitive.where() + "/indices", "element " + std::to_string(k) + " is not a vertex");
    }
    const auto corners = corners_of(primitive.member("mode"), indices, primitive.member("indices"));
    if (!corners) continue;
    const size_t first = mesh.positions.size();
    mesh.positions.insert(mesh.positions.end(), places.begin(), places.end());
    for (size_t k = 0; k < corners->size(); k += 3) {
      std::array<uint32_t, 3> t;
      for (size_t i = 0; i < 3; ++i) {
        t[i] = static_cast<uint32_t>(first + static_cast<size_t>(indices[(*corners)[k + i]]));
      }
      mesh.triangles.push_back(t);
    }
    read_weights(attributes, buffers, places.size(), first, mesh);
    const Value targets = primitive.member("targets");
    if (first > 0 && targets.size() != mesh.targets.size())
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
  if (mesh.triangles.empty()) fail(primitives.where(), "the mesh has no triangles");
  if (!mesh.target_names.empty() && mesh.target_names.size() != mesh.targets.size())
    mesh.target_names.clear();
  return mesh;
}

}  // namespace truestep::gltf
