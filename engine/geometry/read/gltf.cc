#include "engine/geometry/read/gltf.h"

#include <boost/json.hpp>
#include <optional>
#include <utility>

#include "engine/base/text/encoding.h"
#include "engine/geometry/read/gltf/buffers.h"
#include "engine/geometry/read/gltf/extensions.h"
#include "engine/geometry/read/gltf/mesh.h"
#include "engine/geometry/read/gltf/nodes.h"

namespace truestep {

namespace gltf {

namespace {

GltfSkin read_skin(const Value& v, const Buffers& buffers, size_t nodes) {
  GltfSkin skin;
  const Value joints = v.member("joints");
  for (size_t k = 0; k < joints.size(); ++k)
    skin.joints.push_back(static_cast<uint32_t>(joints[k].index(nodes, "node")));
  if (skin.joints.empty()) fail(joints.where(), "a skin needs joints");
  if (v.member("inverseBindMatrices").there()) {
    const std::vector<double> all = buffers.numbers(v.member("inverseBindMatrices"), 16);
    if (all.size() < 16 * skin.joints.size())
      fail(v.where() + "/inverseBindMatrices", "must have as many as there are joints");
    skin.binds.resize(skin.joints.size());
    for (size_t k = 0; k < skin.binds.size(); ++k) std::copy_n(&all[16 * k], 16, skin.binds[k].begin());
  }
  return skin;
}

GltfAnimation read_animation(const Value& v, const Buffers& buffers, size_t nodes) {
  GltfAnimation animation;
  animation.name = v.member("name").text_or("");
  const Value channels = v.member("channels"), samplers = v.member("samplers");
  for (size_t k = 0; k < channels.size(); ++k) {
    const Value target = channels[k].member("target");
    if (!target.member("node").there()) continue;
    GltfChannel c;
    c.node = static_cast<uint32_t>(target.member("node").index(nodes, "node"));
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
      continue;  // belongs to an extension
    }
    const Value sampler = samplers[channels[k].member("sampler").index(samplers.size(), "sampler")];
    c.times = buffers.numbers(sampler.member("input"), 1);
    if (c.times.front() < 0) fail(sampler.where() + "/input", "times must not be negative");
    for (size_t i = 0; i < c.times.size(); ++i) {
      if (i > 0 && !(c.times[i] > c.times[i - 1])) fail(sampler.where() + "/input", "times must ascend");
    }
    const std::string between = sampler.member("interpolation").text_or("LINEAR");
    using B = GltfChannel::Between;
    if (between != "LINEAR" && between != "STEP" && between != "CUBICSPLINE") {
      fail(sampler.where() + "/interpolation", "\"" + between + "\" is none of LINEAR, STEP and CUBICSPLINE");
    }
    c.between = between == "STEP" ? B::step : between == "CUBICSPLINE" ? B::cubic : B::linear;
    c.values = buffers.numbers(sampler.member("output"), c.width == 1 ? 1 : c.width);
    const size_t keys = c.times.size() * (c.between == B::cubic ? 3 : 1);
    if (c.path == P::weights) {
      if (c.values.size() % keys != 0)
        fail(sampler.where() + "/output", "must have the same number for every time");
      c.width = c.values.size() / keys;
    } else if (c.values.size() != keys * c.width) {
      fail(sampler.where() + "/output", "must have as many as there are times");
    }
    animation.channels.push_back(std::move(c));
  }
  return animation;
}

void check_skin_of(GltfModel& model, size_t k) {
  const GltfNode& node = model.nodes[k];
  if (node.mesh < 0 || node.skin < 0) return;
  GltfSkin& skin = model.skins[static_cast<size_t>(node.skin)];
  if (!skin.fault.empty()) return;
  for (const auto& joints : model.meshes[static_cast<size_t>(node.mesh)].joints) {
    for (const uint32_t j : joints) {
      if (j < skin.joints.size()) continue;
      skin.fault = "/nodes/" + std::to_string(k) + ": a vertex follows joint " + std::to_string(j) + " of " +
                   std::to_string(skin.joints.size());
      return;
    }
  }
}

/// Without a fault: a name that is no text is none.
std::string name_of(const Value& v) {
  try {
    return v.member("name").text_or("");
  } catch (const GltfFault&) {
    return "";
  }
}

/// All elements of an array; where one cannot be read, one with its fault.
template <class T>
std::vector<T> read_all(const Value& array, auto read) {
  std::vector<T> out;
  for (size_t k = 0; k < array.size(); ++k) {
    try {
      out.push_back(read(array[k]));
    } catch (const GltfFault& f) {
      out.emplace_back().fault = f.what();
      if constexpr (requires { out.back().name; }) out.back().name = name_of(array[k]);
    }
  }
  return out;
}

GltfModel read_model(const Value& document, std::span<const std::byte> binary) {
  if (!document.member("asset").member("version").text_or("").starts_with("2.")) {
    fail("/asset/version", "must be 2.x");
  }
  check_extensions(document);
  GltfModel model;
  const Buffers buffers(document, binary);
  model.nodes = read_nodes(document);
  const size_t nodes = model.nodes.size();
  model.meshes =
      read_all<GltfMesh>(document.member("meshes"), [&](const Value& v) { return read_mesh(v, buffers); });
  model.skins = read_all<GltfSkin>(document.member("skins"),
                                   [&](const Value& v) { return read_skin(v, buffers, nodes); });
  model.animations = read_all<GltfAnimation>(
      document.member("animations"), [&](const Value& v) { return read_animation(v, buffers, nodes); });
  for (size_t k = 0; k < nodes; ++k) {
    const Value n = document.member("nodes")[k];
    if (n.member("mesh").there())
      model.nodes[k].mesh = static_cast<int32_t>(n.member("mesh").index(model.meshes.size(), "mesh"));
    if (n.member("skin").there())
      model.nodes[k].skin = static_cast<int32_t>(n.member("skin").index(model.skins.size(), "skin"));
    check_skin_of(model, k);
  }
  return model;
}

}  // namespace

}  // namespace gltf

namespace {

constexpr uint32_t kGlb = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

uint32_t little32(std::span<const std::byte> b, size_t at) {
  uint32_t x = 0;
  for (size_t k = 0; k < 4; ++k) x |= static_cast<uint32_t>(b[at + k]) << (8 * k);
  return x;
}

GltfModel read_document(std::string_view text, std::span<const std::byte> binary, size_t offset) {
  boost::json::error_code fault;
  boost::json::stream_parser parser;
  const size_t read = parser.write_some(text.data(), text.size(), fault);
  if (!fault && !parser.done()) parser.finish(fault);
  if (fault) throw GltfFault("byte " + std::to_string(offset + read) + ": " + fault.message());
  const boost::json::value document = parser.release();
  return gltf::read_model({&document, ""}, binary);
}

}  // namespace

GltfModel read_gltf(std::span<const std::byte> bytes) {
  if (bytes.size() < 12 || little32(bytes, 0) != kGlb) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string_view plain = without_byte_order_mark(text);
    return read_document(plain, {}, text.size() - plain.size());
  }
  if (little32(bytes, 4) != 2) throw GltfFault("byte 4: the version of the container must be 2");
  if (little32(bytes, 8) > bytes.size() || little32(bytes, 8) < 12) {
    throw GltfFault("byte 8: the file declares " + std::to_string(little32(bytes, 8)) + " bytes but has " +
                    std::to_string(bytes.size()));
  }
  // What follows the declared length is no part of the container.
  bytes = bytes.first(little32(bytes, 8));
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
  const std::string_view chunk(reinterpret_cast<const char*>(text->data()), text->size());
  const std::string_view plain = without_byte_order_mark(chunk);
  return read_document(plain, binary, text_at + chunk.size() - plain.size());
}

GltfModel read_gltf(std::span<const std::string> lines) {
  std::string all;
  for (const std::string& line : lines) all += line;
  all = without_byte_order_mark(all);
  const size_t first = all.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) throw GltfFault("byte 0: the file is empty");
  if (all[first] == '{') return read_gltf(std::as_bytes(std::span(all)));
  return read_gltf(gltf::from_base64(all, "the file"));
}

}  // namespace truestep
