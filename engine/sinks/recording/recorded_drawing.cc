#include "engine/sinks/recording/recorded_drawing.h"

#include <cmath>
#include <map>

namespace truestep {
namespace {

class Columns {
 public:
  explicit Columns(RecordedDrawing& drawing) : drawing_(drawing) {}

  void add(RecordedShapes& s, const Visual& v) {
    const Vec3 &p = v.shape.position, &size = v.shape.size;
    s.kinds.push_back(static_cast<uint32_t>(v.shape.kind));
    s.positions.insert(s.positions.end(), {p.x, p.y, p.z});
    s.orientations.insert(s.orientations.end(), v.shape.orientation.begin(), v.shape.orientation.end());
    s.sizes.insert(s.sizes.end(), {size.x, size.y, size.z});
    const double none = std::nan("");
    const auto color = v.color.value_or(std::array<double, 3>{none, none, none});
    s.colors.insert(s.colors.end(), color.begin(), color.end());
    s.motions.push_back(static_cast<uint32_t>(v.motion));
    s.groups.push_back(v.group);
    s.meshes.push_back(v.shape.mesh ? mesh(*v.shape.mesh) : RecordedShapes::kNoMesh);
  }

 private:
  uint32_t mesh(const DrawnMesh& m) {
    const auto [at, fresh] = places_.try_emplace(&m, static_cast<uint32_t>(drawing_.meshes.size()));
    if (fresh) drawing_.meshes.push_back({m.positions, m.triangles});
    return at->second;
  }
  RecordedDrawing& drawing_;
  std::map<const DrawnMesh*, uint32_t> places_;
};

// Every triangle with its own corners and normal: what was drawn may have been smooth, the recorded surface
// is the same.
std::shared_ptr<const DrawnMesh> flat_mesh(const RecordedMesh& m) {
  auto out = std::make_shared<DrawnMesh>();
  const auto corner = [&](size_t k) {
    const float* p = &m.positions[3 * size_t{m.triangles[k]}];
    return Vec3{p[0], p[1], p[2]};
  };
  for (size_t t = 0; t + 2 < m.triangles.size(); t += 3) {
    const Vec3 a = corner(t), b = corner(t + 1), c = corner(t + 2);
    const Vec3 n = normalized(cross(b - a, c - a), {0, 1, 0});
    for (const Vec3& x : {a, b, c}) {
      out->triangles.push_back(static_cast<uint32_t>(out->positions.size() / 3));
      for (const double v : {x.x, x.y, x.z}) out->positions.push_back(static_cast<float>(v));
      for (const double v : {n.x, n.y, n.z}) out->normals.push_back(static_cast<float>(v));
    }
  }
  return out;
}

}  // namespace

RecordedDrawing recorded_drawing(std::span<const PartDrawing* const> parts,
                                 std::span<const DrawnShape> obstacles) {
  RecordedDrawing out;
  Columns columns(out);
  for (const PartDrawing* part : parts) {
    RecordedShapes& s = out.parts.emplace_back();
    if (!part) continue;
    s.point_radius = part->point_radius;
    for (const Visual& v : part->visuals) columns.add(s, v);
    for (const auto& i : part->instances) s.instances.insert(s.instances.end(), i.begin(), i.end());
  }
  if (obstacles.empty()) return out;
  RecordedShapes& s = out.parts.emplace_back();
  for (uint32_t k = 0; k < obstacles.size(); ++k) {
    Visual v{.shape = obstacles[k], .color = {}, .motion = Visual::Motion::kinematic};
    v.shape.position = {0, 0, 0};
    v.shape.orientation = {1, 0, 0, 0};
    columns.add(s, v);
    s.instances.insert(s.instances.end(), {k, k});
  }
  return out;
}

void restore_shapes(const RecordedDrawing& drawing, size_t part, PartDrawing& out) {
  if (part >= drawing.parts.size()) return;
  const RecordedShapes& s = drawing.parts[part];
  std::vector<std::shared_ptr<const DrawnMesh>> meshes(drawing.meshes.size());
  out.visuals.clear(), out.instances.clear();
  for (size_t k = 0; k < s.kinds.size(); ++k) {
    Visual& v = out.visuals.emplace_back();
    v.shape.kind = static_cast<DrawnShape::Kind>(s.kinds[k]);
    v.shape.position = {s.positions[3 * k], s.positions[3 * k + 1], s.positions[3 * k + 2]};
    for (size_t c = 0; c < 4; ++c) v.shape.orientation[c] = s.orientations[4 * k + c];
    v.shape.size = {s.sizes[3 * k], s.sizes[3 * k + 1], s.sizes[3 * k + 2]};
    if (!std::isnan(s.colors[3 * k])) v.color = {s.colors[3 * k], s.colors[3 * k + 1], s.colors[3 * k + 2]};
    v.motion = static_cast<Visual::Motion>(s.motions[k]);
    v.group = s.groups[k];
    if (const uint32_t m = s.meshes[k]; m != RecordedShapes::kNoMesh) {
      if (!meshes[m]) meshes[m] = flat_mesh(drawing.meshes[m]);
      v.shape.mesh = meshes[m];
    }
  }
  for (size_t i = 0; i + 1 < s.instances.size(); i += 2)
    out.instances.push_back({s.instances[i], s.instances[i + 1]});
  out.point_radius = s.point_radius;
}

}  // namespace truestep
