#include "engine/geometry/read/gltf/buffers.h"

#include <cstring>

namespace truestep::gltf {

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
    if (v < 0) fail(where, "byte " + std::to_string(k) + " is not a base64 character");
    held = held << 6 | static_cast<uint32_t>(v), bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    out.push_back(static_cast<std::byte>(held >> bits & 0xff));
  }
  return out;
}

namespace {

double component_at(const std::byte* p, int type, bool normalised) {
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

}  // namespace

Buffers::Buffers(const Value& document, std::span<const std::byte> binary) : document_(document) {
  const Value buffers = document_.member("buffers");
  for (size_t k = 0; k < buffers.size(); ++k) {
    const Value uri = buffers[k].member("uri");
    std::vector<std::byte> bytes;
    if (uri.there()) {
      const std::string text = uri.text_or("");
      const size_t comma = text.find(";base64,");
      if (!text.starts_with("data:") || comma == std::string::npos) {
        fail(uri.where(), "only data URIs in base64 are read, not external files");
      }
      bytes = from_base64(std::string_view(text).substr(comma + 8), uri.where());
    } else if (k == 0) {
      bytes.assign(binary.begin(), binary.end());
    } else {
      fail(buffers[k].where(), "has no data");
    }
    const double length = buffers[k].member("byteLength").number();
    if (!(length >= 0) || length > static_cast<double>(bytes.size())) {
      fail(buffers[k].where() + "/byteLength", "there are only " + std::to_string(bytes.size()) + " bytes");
    }
    buffers_.push_back(std::move(bytes));
  }
}

std::vector<double> Buffers::numbers(const Value& reference, size_t width, bool normalised_integers) const {
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
    fail(a.where() + "/type", "\"" + type + "\" is the wrong type here");
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
      fail(a.where() + "/componentType", "is not a component type of glTF");
  }
  const double count = a.member("count").number();
  if (!(count >= 1) || count != std::floor(count))
    fail(a.where() + "/count", "must be a whole number above 0");
  const Value view = views[a.member("bufferView").index(views.size(), "buffer view")];
  const std::vector<std::byte>& buffer = buffers_[view.member("buffer").index(buffers_.size(), "buffer")];
  const double offset = view.member("byteOffset").number_or(0), inside = a.member("byteOffset").number_or(0);
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

std::vector<Vec3> Buffers::vectors(const Value& reference) const {
  const std::vector<double> all = numbers(reference, 3, true);
  std::vector<Vec3> out(all.size() / 3);
  for (size_t k = 0; k < out.size(); ++k) out[k] = {all[3 * k], all[3 * k + 1], all[3 * k + 2]};
  return out;
}

}  // namespace truestep::gltf
