// glTF 2.0 (Khronos 2017): nodes 0 to n - 1 are the joints, a node after them carries the mesh; all data is
// in one binary buffer, with numbers in f32 as the format requires.
#include <boost/json.hpp>
#include <cmath>
#include <cstring>

#include "engine/core/ports/morph_port.h"
#include "engine/core/ports/rig_port.h"
#include "engine/sinks/motion/motion_export.h"

namespace truestep {

namespace json = boost::json;

using animation::conjugate;
using animation::rotate;

struct MotionExport::Document {
  json::array nodes, meshes, skins, accessors, views, channels, samplers;
  json::array roots;
  std::string binary;

  /// Appends rows of `width` numbers; returns the accessor's index.
  size_t numbers(std::span<const double> all, size_t width, bool bounds) {
    static constexpr const char* kTypes[] = {"", "SCALAR", "", "VEC3", "VEC4"};
    const size_t first = view(all.size() * 4);
    for (const double x : all) append(static_cast<float>(x));
    json::object a{{"bufferView", first},
                   {"componentType", 5126},
                   {"count", all.size() / width},
                   {"type", width == 16 ? "MAT4" : kTypes[width]}};
    if (bounds) {
      json::array low, high;
      for (size_t c = 0; c < width; ++c) {
        float least = HUGE_VALF, most = -HUGE_VALF;
        for (size_t r = c; r < all.size(); r += width) {
          least = std::min(least, static_cast<float>(all[r])),
          most = std::max(most, static_cast<float>(all[r]));
        }
        low.push_back(least), high.push_back(most);
      }
      a["min"] = std::move(low), a["max"] = std::move(high);
    }
    accessors.push_back(std::move(a));
    return accessors.size() - 1;
  }
  size_t vectors(std::span<const Vec3> all, bool bounds) {
    std::vector<double> flat;
    for (const Vec3& x : all) flat.insert(flat.end(), {x.x, x.y, x.z});
    return numbers(flat, 3, bounds);
  }
  /// u32 scalars, or u16 rows of four.
  size_t indices(std::span<const std::array<uint32_t, 3>> triangles) {
    const size_t first = view(triangles.size() * 12);
    for (const auto& t : triangles) {
      for (const uint32_t i : t) append(i);
    }
    accessors.push_back(json::object{
        {"bufferView", first}, {"componentType", 5125}, {"count", 3 * triangles.size()}, {"type", "SCALAR"}});
    return accessors.size() - 1;
  }
  size_t joints(std::span<const animation::SkinWeights> weights) {
    const size_t first = view(weights.size() * 8);
    for (const auto& w : weights) {
      for (const uint32_t b : w.bone) append(static_cast<uint16_t>(b));
    }
    accessors.push_back(json::object{
        {"bufferView", first}, {"componentType", 5123}, {"count", weights.size()}, {"type", "VEC4"}});
    return accessors.size() - 1;
  }
  void channel(size_t node, const char* path, size_t times, size_t values) {
    samplers.push_back(json::object{{"input", times}, {"output", values}, {"interpolation", "LINEAR"}});
    channels.push_back(json::object{{"sampler", samplers.size() - 1},
                                    {"target", json::object{{"node", node}, {"path", path}}}});
  }
  json::object document(const std::string& name) const {
    json::object o{{"asset", json::object{{"version", "2.0"}, {"generator", "truestep"}}},
                   {"scene", 0},
                   {"scenes", json::array{json::object{{"nodes", roots}}}},
                   {"nodes", nodes},
                   {"accessors", accessors},
                   {"bufferViews", views}};
    if (!meshes.empty()) o["meshes"] = meshes;
    if (!skins.empty()) o["skins"] = skins;
    if (!channels.empty()) {
      o["animations"] =
          json::array{json::object{{"name", name}, {"channels", channels}, {"samplers", samplers}}};
    }
    return o;
  }

 private:
  template <class T>
  void append(T x) {
    char bytes[sizeof x];
    std::memcpy(bytes, &x, sizeof x);
    binary.append(bytes, sizeof x);
  }
  size_t view(size_t bytes) {
    binary.resize((binary.size() + 3) / 4 * 4);
    views.push_back(json::object{{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes}});
    return views.size() - 1;
  }
};

namespace {

json::array array_of(const Vec3& v) {
  return {v.x, v.y, v.z};
}
json::array array_of(const Quat& q) {
  return {q.x, q.y, q.z, q.w};
}
void append(std::vector<double>& out, const Quat& q) {
  out.insert(out.end(), {q.x, q.y, q.z, q.w});
}
void append(std::vector<double>& out, const Vec3& v) {
  out.insert(out.end(), {v.x, v.y, v.z});
}
/// Columns of the inverse of a pose.
void append_inverse(std::vector<double>& out, const Pose& p) {
  const Quat back = conjugate(p.orientation);
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    append(out, rotate(back, axis));
    out.push_back(0);
  }
  append(out, rotate(back, -p.position));
  out.push_back(1);
}

std::string base64(std::string_view bytes) {
  static constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t k = 0; k < bytes.size(); k += 3) {
    uint32_t three = 0;
    for (size_t i = 0; i < 3; ++i)
      three = three << 8 | (k + i < bytes.size() ? static_cast<uint8_t>(bytes[k + i]) : 0u);
    for (size_t i = 0; i < 4; ++i) out += k + i > bytes.size() ? '=' : kLetters[three >> (18 - 6 * i) & 63];
  }
  return out;
}

void append_little(std::string& out, size_t x) {
  for (size_t k = 0; k < 4; ++k) out += static_cast<char>(x >> (8 * k) & 0xff);
}

}  // namespace

void MotionExport::add_skeleton(Document& d) const {
  const auto rig = *rig_of(system_);
  const size_t n = rig.joints.size();
  for (size_t j = 0; j < n; ++j) {
    const Pose& rest = rig.joints[j].rest;
    json::object node{{"name", rig.names[j]},
                      {"translation", array_of(rest.position)},
                      {"rotation", array_of(rest.orientation)}};
    json::array children;
    for (size_t c = j + 1; c < n; ++c) {
      if (rig.joints[c].parent == static_cast<int32_t>(j)) children.push_back(c);
    }
    if (!children.empty()) node["children"] = std::move(children);
    if (rig.joints[j].parent < 0) d.roots.push_back(j);
    d.nodes.push_back(std::move(node));
  }
  if (!rig.skin.empty()) {
    std::vector<double> binds, weights;
    json::array joints;
    for (size_t j = 0; j < n; ++j) append_inverse(binds, rig.rest[j]), joints.push_back(j);
    for (const auto& w : rig.weights) weights.insert(weights.end(), w.weight.begin(), w.weight.end());
    const size_t matrices = d.numbers(binds, 16, false);
    d.skins.push_back(json::object{{"joints", std::move(joints)}, {"inverseBindMatrices", matrices}});
    json::object attributes{{"POSITION", d.vectors(rig.skin, true)}};
    attributes["JOINTS_0"] = d.joints(rig.weights);
    attributes["WEIGHTS_0"] = d.numbers(weights, 4, false);
    json::object primitive{{"attributes", std::move(attributes)}, {"indices", d.indices(rig.triangles)}};
    d.meshes.push_back(json::object{{"name", name_}, {"primitives", json::array{std::move(primitive)}}});
    d.roots.push_back(n);
    d.nodes.push_back(json::object{{"name", name_}, {"mesh", 0}, {"skin", 0}});
  }
  if (frames_ == 0) return;
  std::vector<double> times;
  for (size_t f = 0; f < frames_; ++f) times.push_back(static_cast<double>(f) / rate_);
  const size_t input = d.numbers(times, 1, true);
  for (size_t j = 0; j < n; ++j) {
    std::vector<double> turns, places;
    bool moves = false;
    for (size_t f = 0; f < frames_; ++f) {
      const Pose& p = locals_[f * n + j];
      append(turns, p.orientation), append(places, p.position);
      moves = moves || norm(p.position - rig.joints[j].rest.position) > 1e-9;
    }
    d.channel(j, "rotation", input, d.numbers(turns, 4, false));
    if (moves) d.channel(j, "translation", input, d.numbers(places, 3, false));
  }
}

void MotionExport::add_surface(Document& d) const {
  const Morphed::Port port = system_.ports().morph->morph();
  json::object primitive{{"attributes", json::object{{"POSITION", d.vectors(port.base, true)}}}};
  if (!port.triangles.empty()) primitive["indices"] = d.indices(port.triangles);
  json::array targets, names;
  for (size_t k = 0; k < port.targets.size(); ++k) {
    std::vector<Vec3> offsets(port.base.size());
    for (size_t i = 0; i < port.targets[k].rows.size(); ++i)
      offsets[port.targets[k].rows[i]] = port.targets[k].offsets[i];
    targets.push_back(json::object{{"POSITION", d.vectors(offsets, true)}});
    names.push_back(json::string(port.names[k]));
  }
  json::object mesh{{"extras", json::object{{"targetNames", std::move(names)}}}};
  if (!targets.empty()) primitive["targets"] = std::move(targets);
  mesh["primitives"] = json::array{std::move(primitive)};
  mesh["name"] = name_;
  d.meshes.push_back(std::move(mesh));
  d.roots.push_back(0);
  d.nodes.push_back(json::object{{"name", name_}, {"mesh", 0}});
  if (frames_ == 0) return;
  std::vector<double> times, turns, places;
  for (size_t f = 0; f < frames_; ++f) {
    times.push_back(static_cast<double>(f) / rate_);
    append(turns, locals_[f].orientation), append(places, locals_[f].position);
  }
  const size_t input = d.numbers(times, 1, true);
  d.channel(0, "rotation", input, d.numbers(turns, 4, false));
  d.channel(0, "translation", input, d.numbers(places, 3, false));
  if (!weights_.empty()) d.channel(0, "weights", input, d.numbers(weights_, 1, false));
}

MotionExport::Document MotionExport::document() const {
  Document d;
  if (system_.ports().rig) {
    add_skeleton(d);
  } else {
    add_surface(d);
  }
  d.binary.resize((d.binary.size() + 3) / 4 * 4);
  return d;
}

std::string MotionExport::gltf() const {
  const Document d = document();
  json::object o = d.document(name_);
  o["buffers"] = json::array{json::object{
      {"byteLength", d.binary.size()}, {"uri", "data:application/octet-stream;base64," + base64(d.binary)}}};
  return json::serialize(o) + "\n";
}

std::string MotionExport::glb() const {
  const Document d = document();
  json::object o = d.document(name_);
  o["buffers"] = json::array{json::object{{"byteLength", d.binary.size()}}};
  std::string text = json::serialize(o);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string out = "glTF";
  append_little(out, 2), append_little(out, 12 + 8 + text.size() + 8 + d.binary.size());
  append_little(out, text.size()), out += "JSON", out += text;
  append_little(out, d.binary.size()), out += std::string("BIN\0", 4), out += d.binary;
  return out;
}

}  // namespace truestep
