#include "engine/geometry/read/gltf.h"

#include <boost/json.hpp>
#include <cmath>
#include <cstring>
#include <optional>

namespace truestep {

namespace {

namespace json = boost::json;

constexpr uint32_t kGlb = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr size_t kMostNodes = 100'000;
constexpr double kMostValue = 1e12;

[[noreturn]] void fail(const std::string& where, const std::string& why) {
  throw GltfFault(where + ": " + why);
}

uint32_t little32(std::span<const std::byte> b, size_t at) {
  uint32_t x = 0;
  for (size_t k = 0; k < 4; ++k) x |= static_cast<uint32_t>(b[at + k]) << (8 * k);
  return x;
}

std::vector<std::byte> from_base64(std::string_view text, const std::string& where) {
  std::vector<std::byte> out;
  out.reserve(text.size() / 4 * 3);
  uint32_t held = 0;
  int bits = 0;
  for (size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    int v = -1;
    if (c >= 'A' && c <= 'Z') v = c - 'A';
    if (c >= 'a' && c <= 'z') v = c - 'a' + 26;
    if (c >= '0' && c <= '9') v = c - '0' + 52;
    if (c == '+' || c == '-') v = 62;
    if (c == '/' || c == '_') v = 63;
    if (c == '=') break;
    if (c == '\n' || c == '\r' || c == ' ') continue;
    if (v < 0) fail(where, "byte " + std::to_string(k) + " is not of base64");
    held = held << 6 | static_cast<uint32_t>(v), bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    out.push_back(static_cast<std::byte>(held >> bits & 0xff));
  }
  return out;
}

/// The document's values with where they stand.
class Value {
 public:
  Value(const json::value* v, std::string where) : v_(v), where_(std::move(where)) {}
  const std::string& where() const { return where_; }
  bool there() const { return v_ != nullptr; }
  Value member(std::string_view name) const {
    const std::string at = where_ + "/" + std::string(name);
    if (!v_) return {nullptr, at};
    const auto* o = v_->if_object();
    if (!o) fail(where_, "is no object");
    return {o->if_contains(name), at};
  }
  size_t size() const {
    if (!v_) return 0;
    const auto* a = v_->if_array();
    if (!a) fail(where_, "is no array");
    return a->size();
  }
  Value operator[](size_t k) const {
    const std::string at = where_ + "/" + std::to_string(k);
    if (k >= size()) fail(at, "is not there");
    return {&v_->get_array()[k], at};
  }
  double number() const {
    if (!v_) fail(where_, "is not there");
    double x = 0;
    if (v_->is_double()) {
      x = v_->get_double();
    } else if (v_->is_int64()) {
      x = static_cast<double>(v_->get_int64());
    } else if (v_->is_uint64()) {
      x = static_cast<double>(v_->get_uint64());
    } else {
      fail(where_, "is no number");
    }
    if (!(std::abs(x) <= kMostValue)) fail(where_, "is not finite or too large");
    return x;
  }
  double number_or(double otherwise) const { return v_ ? number() : otherwise; }
  /// A whole number from 0 to below `count`.
  size_t index(size_t count, const char* what) const {
    const double x = number();
    if (!(x >= 0 && x < static_cast<double>(count)) || x != std::floor(x)) {
      fail(where_, "there is no " + std::string(what) + " " + std::to_string(x));
    }
    return static_cast<size_t>(x);
  }
  std::string text_or(const std::string& otherwise) const {
    if (!v_) return otherwise;
    const auto* s = v_->if_string();
    if (!s) fail(where_, "is no text");
    return std::string(*s);
  }

 private:
  const json::value* v_;
  std::string where_;
};

class Reader {
 public:
  Reader(const json::value& document, std::span<const std::byte> binary)
      : document_(&document, ""), binary_(binary) {}

  GltfModel read() {
    if (!document_.member("asset").member("version").text_or("").starts_with("2.")) {
      fail("/asset/version", "is not 2.x");
    }
    read_buffers();
    read_nodes();
    const Value meshes = document_.member("meshes");
    for (size_t k = 0; k < meshes.size(); ++k) read_mesh(meshes[k]);
    const Value skins = document_.member("skins");
    for (size_t k = 0; k < skins.size(); ++k) read_skin(skins[k]);
    const Value animations = document_.member("animations");
    for (size_t k = 0; k < animations.size(); ++k) read_animation(animations[k]);
    for (size_t k = 0; k < model_.nodes.size(); ++k) {
      const Value n = document_.member("nodes")[k];
      if (n.member("mesh").there())
        model_.nodes[k].mesh = static_cast<int32_t>(n.member("mesh").index(model_.meshes.size(), "mesh"));
      if (n.member("skin").there())
        model_.nodes[k].skin = static_cast<int32_t>(n.member("skin").index(model_.skins.size(), "skin"));
      check_skin_of(k);
    }
    return std::move(model_);
  }

 private:
  void read_buffers() {
    const Value buffers = document_.member("buffers");
    for (size_t k = 0; k < buffers.size(); ++k) {
      const Value uri = buffers[k].member("uri");
      std::vector<std::byte> bytes;
      if (uri.there()) {
        const std::string text = uri.text_or("");
        const size_t comma = text.find(";base64,");
        if (!text.starts_with("data:") || comma == std::string::npos) {
          fail(uri.where(), "only data URIs in base64 are read, no files beside this one");
        }
        bytes = from_base64(std::string_view(text).substr(comma + 8), uri.where());
      } else if (k == 0) {
        bytes.assign(binary_.begin(), binary_.end());
      } else {
        fail(buffers[k].where(), "has no data");
      }
      const double length = buffers[k].member("byteLength").number();
      if (!(length >= 0) || length > static_cast<double>(bytes.size())) {
        fail(buffers[k].where() + "/byteLength", "there are " + std::to_string(bytes.size()) + " bytes only");
      }
      buffers_.push_back(std::move(bytes));
    }
  }

  void read_nodes() {
    const Value nodes = document_.member("nodes");
    const size_t n = nodes.size();
    if (n > kMostNodes) fail("/nodes", "there are more than " + std::to_string(kMostNodes));
    model_.nodes.resize(n);
    for (size_t k = 0; k < n; ++k) {
      GltfNode& node = model_.nodes[k];
      node.name = nodes[k].member("name").text_or("node" + std::to_string(k));
      place(nodes[k], node);
      const Value children = nodes[k].member("children");
      for (size_t c = 0; c < children.size(); ++c) {
        GltfNode& child = model_.nodes[children[c].index(n, "node")];
        if (child.parent >= 0) fail(children[c].where(), "the node has a parent already");
        child.parent = static_cast<int32_t>(k);
      }
    }
    // Every node has one parent at most: a way up that is longer than there are nodes is a cycle.
    std::vector<uint8_t> sound(n, 0);
    for (size_t k = 0; k < n; ++k) {
      size_t steps = 0;
      for (auto j = static_cast<int32_t>(k); j >= 0 && !sound[static_cast<size_t>(j)];
           j = model_.nodes[static_cast<size_t>(j)].parent) {
        if (++steps > n) fail("/nodes/" + std::to_string(k), "is its own ancestor");
      }
      for (auto j = static_cast<int32_t>(k); j >= 0 && !sound[static_cast<size_t>(j)];
           j = model_.nodes[static_cast<size_t>(j)].parent) {
        sound[static_cast<size_t>(j)] = 1;
      }
    }
  }

  static void place(const Value& v, GltfNode& node) {
    double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    const auto take = [&](const char* name, double* out, size_t count) {
      const Value a = v.member(name);
      if (!a.there()) return false;
      if (a.size() != count) fail(a.where(), "has not " + std::to_string(count) + " numbers");
      for (size_t k = 0; k < count; ++k) out[k] = a[k].number();
      return true;
    };
    double m[16];
    if (take("matrix", m, 16)) {
      Vec3 axis[3];
      for (size_t k = 0; k < 3; ++k) {
        axis[k] = {m[4 * k], m[4 * k + 1], m[4 * k + 2]};
        s[k] = norm(axis[k]);
        if (!(s[k] > 0)) fail(v.where() + "/matrix", "is singular");
        axis[k] = axis[k] / s[k];
      }
      const double skew =
          std::abs(dot(axis[0], axis[1])) + std::abs(dot(axis[0], axis[2])) + std::abs(dot(axis[1], axis[2]));
      if (skew > 1e-3 || dot(cross(axis[0], axis[1]), axis[2]) < 0)
        fail(v.where() + "/matrix", "shears or mirrors");
      rotation_of(axis, q);
      for (size_t k = 0; k < 3; ++k) t[k] = m[12 + k];
    } else {
      take("translation", t, 3), take("rotation", q, 4), take("scale", s, 3);
    }
    if (!(s[0] > 0) || std::abs(s[1] - s[0]) > 1e-3 * s[0] || std::abs(s[2] - s[0]) > 1e-3 * s[0]) {
      fail(v.where() + "/scale", "is not the same in all directions");
    }
    const Quat turn{q[3], q[0], q[1], q[2]};
    const double length = std::sqrt(turn.w * turn.w + turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
    if (!(length > 1e-6)) fail(v.where() + "/rotation", "is no rotation");
    node.local = {{t[0], t[1], t[2]}, normalized(turn)};
    node.scale = s[0];
  }
  /// x, y, z, w of the rotation with these columns, by its largest component (Shepperd 1978).
  static void rotation_of(const Vec3* c, double* q) {
    const double xx = c[0].x, yy = c[1].y, zz = c[2].z, trace = xx + yy + zz;
    const double four[] = {1 + 2 * xx - trace, 1 + 2 * yy - trace, 1 + 2 * zz - trace, 1 + trace};
    size_t k = 0;
    for (size_t i = 1; i < 4; ++i) {
      if (four[i] > four[k]) k = i;
    }
    const double a = std::sqrt(four[k]), f = 0.5 / a;
    const double yz = c[1].z - c[2].y, zx = c[2].x - c[0].z, xy = c[0].y - c[1].x;
    const double sxy = c[0].y + c[1].x, szx = c[2].x + c[0].z, syz = c[1].z + c[2].y;
    const double all[4][4] = {{0, sxy, szx, yz}, {sxy, 0, syz, zx}, {szx, syz, 0, xy}, {yz, zx, xy, 0}};
    for (size_t i = 0; i < 4; ++i) q[i] = i == k ? 0.5 * a : all[k][i] * f;
  }

  /// All numbers of an accessor, row by row.
  std::vector<double> numbers(const Value& reference, size_t width, bool normalised_integers) {
    const Value accessors = document_.member("accessors"), views = document_.member("bufferViews");
    const Value a = accessors[reference.index(accessors.size(), "accessor")];
    if (a.member("sparse").there()) fail(a.where() + "/sparse", "sparse accessors are not read");
    static constexpr std::pair<const char*, size_t> kTypes[] = {
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    const std::string type = a.member("type").text_or("");
    size_t columns = 0;
    for (const auto& [name, count] : kTypes) {
      if (type == name) columns = count;
    }
    if (columns == 0 || (width != 0 && columns != width)) {
      fail(a.where() + "/type", "\"" + type + "\" is not what belongs here");
    }
    const auto component = static_cast<int>(a.member("componentType").number());
    size_t size = 0;
    switch (component) {
      case 5120:
      case 5121:
        size = 1;
        break;
      case 5122:
      case 5123:
        size = 2;
        break;
      case 5125:
      case 5126:
        size = 4;
        break;
      default:
        fail(a.where() + "/componentType", "is no type of glTF");
    }
    const double count = a.member("count").number();
    if (!(count >= 1) || count != std::floor(count)) fail(a.where() + "/count", "is no count");
    const Value view = views[a.member("bufferView").index(views.size(), "buffer view")];
    const std::vector<std::byte>& buffer = buffers_[view.member("buffer").index(buffers_.size(), "buffer")];
    const double offset = view.member("byteOffset").number_or(0),
                 inside = a.member("byteOffset").number_or(0);
    const double length = view.member("byteLength").number();
    const double row = static_cast<double>(size * columns);
    const double stride = view.member("byteStride").number_or(row);
    if (!(offset >= 0) || !(inside >= 0) || !(length >= 0) ||
        offset + length > static_cast<double>(buffer.size())) {
      fail(view.where(), "reaches beyond its buffer of " + std::to_string(buffer.size()) + " bytes");
    }
    if (!(stride >= row) || stride != std::floor(stride) || inside != std::floor(inside) ||
        offset != std::floor(offset) || inside + (count - 1) * stride + row > length) {
      fail(a.where(),
           "reaches beyond its buffer view of " + std::to_string(static_cast<size_t>(length)) + " bytes");
    }
    const auto rows = static_cast<size_t>(count);
    std::vector<double> out;
    out.reserve(rows * columns);
    const std::byte* at = buffer.data() + static_cast<size_t>(offset) + static_cast<size_t>(inside);
    for (size_t r = 0; r < rows; ++r) {
      for (size_t c = 0; c < columns; ++c) {
        const std::byte* p = at + r * static_cast<size_t>(stride) + c * size;
        const double x = component_at(p, component, normalised_integers);
        if (!(std::abs(x) <= kMostValue)) {
          fail(a.where(), "element " + std::to_string(r) + " is not finite or too large");
        }
        out.push_back(x);
      }
    }
    return out;
  }
  static double component_at(const std::byte* p, int type, bool normalised) {
    uint32_t bits = 0;
    const size_t size = type <= 5121 ? 1 : type <= 5123 ? 2 : 4;
    for (size_t k = 0; k < size; ++k) bits |= static_cast<uint32_t>(p[k]) << (8 * k);
    switch (type) {
      case 5120:
        return normalised ? std::max(static_cast<int8_t>(bits) / 127.0, -1.0) : static_cast<int8_t>(bits);
      case 5121:
        return normalised ? bits / 255.0 : bits;
      case 5122:
        return normalised ? std::max(static_cast<int16_t>(bits) / 32767.0, -1.0) : static_cast<int16_t>(bits);
      case 5123:
        return normalised ? bits / 65535.0 : bits;
      case 5125:
        return bits;
      default: {
        float x = 0;
        std::memcpy(&x, &bits, sizeof x);
        return x;
      }
    }
  }
  std::vector<Vec3> vectors(const Value& reference) {
    const std::vector<double> all = numbers(reference, 3, true);
    std::vector<Vec3> out(all.size() / 3);
    for (size_t k = 0; k < out.size(); ++k) out[k] = {all[3 * k], all[3 * k + 1], all[3 * k + 2]};
    return out;
  }

  void read_mesh(const Value& v) {
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
      const std::vector<Vec3> places = vectors(attributes.member("POSITION"));
      const size_t first = mesh.positions.size();
      mesh.positions.insert(mesh.positions.end(), places.begin(), places.end());
      std::vector<double> indices;
      if (primitive.member("indices").there()) {
        indices = numbers(primitive.member("indices"), 1, false);
      } else {
        for (size_t k = 0; k < places.size(); ++k) indices.push_back(static_cast<double>(k));
      }
      if (indices.size() % 3 != 0) fail(primitive.where() + "/indices", "are not three a triangle");
      for (size_t k = 0; k < indices.size(); k += 3) {
        std::array<uint32_t, 3> t;
        for (size_t i = 0; i < 3; ++i) {
          if (!(indices[k + i] >= 0 && indices[k + i] < static_cast<double>(places.size()))) {
            fail(primitive.where() + "/indices", "element " + std::to_string(k + i) + " is no vertex");
          }
          t[i] = static_cast<uint32_t>(first + static_cast<size_t>(indices[k + i]));
        }
        mesh.triangles.push_back(t);
      }
      read_weights(attributes, places.size(), first, mesh);
      const Value targets = primitive.member("targets");
      if (p > 0 && targets.size() != mesh.targets.size())
        fail(targets.where(), "are not as many as in the first primitive");
      mesh.targets.resize(targets.size());
      for (size_t k = 0; k < targets.size(); ++k) {
        mesh.targets[k].resize(first);
        std::vector<Vec3> offsets(places.size());
        if (targets[k].member("POSITION").there()) offsets = vectors(targets[k].member("POSITION"));
        if (offsets.size() != places.size()) fail(targets[k].where(), "has not as many vertices as the base");
        mesh.targets[k].insert(mesh.targets[k].end(), offsets.begin(), offsets.end());
      }
    }
    if (!mesh.target_names.empty() && mesh.target_names.size() != mesh.targets.size())
      mesh.target_names.clear();
    model_.meshes.push_back(std::move(mesh));
  }
  void read_weights(const Value& attributes, size_t count, size_t first, GltfMesh& mesh) {
    const Value joints = attributes.member("JOINTS_0"), weights = attributes.member("WEIGHTS_0");
    if (!joints.there()) {
      if (!mesh.joints.empty()) fail(attributes.where(), "a part of the mesh has no JOINTS_0");
      return;
    }
    if (mesh.joints.size() != first) fail(attributes.where(), "a part of the mesh has no JOINTS_0");
    const std::vector<double> j = numbers(joints, 4, false), w = numbers(weights, 4, true);
    if (j.size() != 4 * count || w.size() != 4 * count)
      fail(joints.where(), "are not as many as there are positions");
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
  void check_skin_of(size_t k) {
    const GltfNode& node = model_.nodes[k];
    if (node.mesh < 0 || node.skin < 0) return;
    const size_t count = model_.skins[static_cast<size_t>(node.skin)].joints.size();
    for (const auto& joints : model_.meshes[static_cast<size_t>(node.mesh)].joints) {
      for (const uint32_t j : joints) {
        if (j >= count)
          fail("/nodes/" + std::to_string(k),
               "a vertex follows joint " + std::to_string(j) + " of " + std::to_string(count));
      }
    }
  }

  void read_skin(const Value& v) {
    GltfSkin skin;
    const Value joints = v.member("joints");
    for (size_t k = 0; k < joints.size(); ++k)
      skin.joints.push_back(static_cast<uint32_t>(joints[k].index(model_.nodes.size(), "node")));
    if (skin.joints.empty()) fail(joints.where(), "a skin has joints");
    if (v.member("inverseBindMatrices").there()) {
      const std::vector<double> all = numbers(v.member("inverseBindMatrices"), 16, false);
      if (all.size() < 16 * skin.joints.size())
        fail(v.where() + "/inverseBindMatrices", "are fewer than the joints");
      skin.binds.resize(skin.joints.size());
      for (size_t k = 0; k < skin.binds.size(); ++k) std::copy_n(&all[16 * k], 16, skin.binds[k].begin());
    }
    model_.skins.push_back(std::move(skin));
  }

  void read_animation(const Value& v) {
    GltfAnimation animation;
    animation.name = v.member("name").text_or("");
    const Value channels = v.member("channels"), samplers = v.member("samplers");
    for (size_t k = 0; k < channels.size(); ++k) {
      const Value target = channels[k].member("target");
      if (!target.member("node").there()) continue;
      GltfChannel c;
      c.node = static_cast<uint32_t>(target.member("node").index(model_.nodes.size(), "node"));
      const std::string path = target.member("path").text_or("");
      using P = GltfChannel::Path;
      if (path == "translation") {
        c.path = P::translation, c.width = 3;
      } else if (path == "rotation") {
        c.path = P::rotation, c.width = 4;
      } else if (path == "scale") {
        c.path = P::scale, c.width = 3;
      } else if (path == "weights") {
        c.path = P::weights, c.width = 1;
      } else {
        continue;  // an extension's
      }
      const Value sampler = samplers[channels[k].member("sampler").index(samplers.size(), "sampler")];
      c.times = numbers(sampler.member("input"), 1, false);
      for (size_t i = 0; i < c.times.size(); ++i) {
        if (i > 0 && !(c.times[i] > c.times[i - 1])) fail(sampler.where() + "/input", "times do not ascend");
      }
      const std::string between = sampler.member("interpolation").text_or("LINEAR");
      using B = GltfChannel::Between;
      c.between = between == "STEP" ? B::step : between == "CUBICSPLINE" ? B::cubic : B::linear;
      c.values = numbers(sampler.member("output"), c.width == 1 ? 1 : c.width, true);
      const size_t keys = c.times.size() * (c.between == B::cubic ? 3 : 1);
      if (c.path == P::weights) {
        if (c.values.size() % keys != 0) fail(sampler.where() + "/output", "are not as many for every time");
        c.width = c.values.size() / keys;
      } else if (c.values.size() != keys * c.width) {
        fail(sampler.where() + "/output", "are not as many as there are times");
      }
      animation.channels.push_back(std::move(c));
    }
    model_.animations.push_back(std::move(animation));
  }

  Value document_;
  std::span<const std::byte> binary_;
  std::vector<std::vector<std::byte>> buffers_;
  GltfModel model_;
};

GltfModel read_document(std::string_view text, std::span<const std::byte> binary, size_t offset) {
  json::error_code fault;
  json::stream_parser parser;
  const size_t read = parser.write_some(text.data(), text.size(), fault);
  if (!fault && !parser.done()) parser.finish(fault);
  if (fault) throw GltfFault("byte " + std::to_string(offset + read) + ": " + fault.message());
  const json::value document = parser.release();
  return Reader(document, binary).read();
}

}  // namespace

GltfModel read_gltf(std::span<const std::byte> bytes) {
  if (bytes.size() < 12 || little32(bytes, 0) != kGlb) {
    return read_document({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, {}, 0);
  }
  if (little32(bytes, 4) != 2) throw GltfFault("byte 4: the container's version is not 2");
  if (little32(bytes, 8) != bytes.size()) {
    throw GltfFault("byte 8: the file says it has " + std::to_string(little32(bytes, 8)) + " bytes and has " +
                    std::to_string(bytes.size()));
  }
  std::optional<std::span<const std::byte>> text;
  std::span<const std::byte> binary;
  size_t text_at = 0;
  for (size_t at = 12; at < bytes.size();) {
    if (bytes.size() - at < 8)
      throw GltfFault("byte " + std::to_string(at) + ": the file ends in a chunk's heading");
    const size_t length = little32(bytes, at);
    const uint32_t kind = little32(bytes, at + 4);
    if (length > bytes.size() - at - 8)
      throw GltfFault("byte " + std::to_string(at) + ": the chunk is longer than the file");
    const auto chunk = bytes.subspan(at + 8, length);
    if (kind == kJsonChunk && !text) text = chunk, text_at = at + 8;
    if (kind == kBinaryChunk && binary.empty()) binary = chunk;
    at += 8 + length;
  }
  if (!text) throw GltfFault("byte 12: there is no JSON chunk");
  return read_document({reinterpret_cast<const char*>(text->data()), text->size()}, binary, text_at);
}

GltfModel read_gltf(std::span<const std::string> lines) {
  std::string all;
  for (const std::string& line : lines) all += line;
  const size_t first = all.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) throw GltfFault("byte 0: there is nothing");
  if (all[first] == '{') return read_gltf(std::as_bytes(std::span(all)));
  return read_gltf(from_base64(all, "the file"));
}

}  // namespace truestep
