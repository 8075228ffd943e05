#include "engine/geometry/read/gltf/buffers.h"

#include <algorithm>
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

/// Floats and integers of 32 bits are never fractions.
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

size_t size_of(int component, const Value& at) {
  switch (component) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      fail(at.where(), "is not a component type of glTF");
  }
}

size_t columns_of(const Value& type, size_t wanted) {
  static constexpr std::pair<const char*, size_t> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  const std::string text = type.text_or("");
  for (const auto& [name, count] : kTypes) {
    if (text == name && count == wanted) return count;
  }
  fail(type.where(), "\"" + text + "\" is the wrong type here");
}

size_t count_of(const Value& v) {
  const double count = v.number();
  if (!(count >= 1) || count != std::floor(count)) fail(v.where(), "must be a whole number above 0");
  return static_cast<size_t>(count);
}

}  // namespace

Buffers::Buffers(const Value& document, std::span<const std::byte> binary) : document_(document) {
  const Value buffers = document_.member("buffers");
  for (size_t k = 0; k < buffers.size(); ++k) {
    Buffer& b = buffers_.emplace_back();
    try {
      const Value uri = buffers[k].member("uri");
      if (uri.there()) {
        const std::string text = uri.text_or("");
        const size_t comma = text.find(";base64,");
        if (!text.starts_with("data:") || comma == std::string::npos) {
          fail(uri.where(), "only data URIs in base64 are read, not external files");
        }
        b.bytes = from_base64(std::string_view(text).substr(comma + 8), uri.where());
      } else if (k == 0 && !binary.empty()) {
        b.bytes.assign(binary.begin(), binary.end());
      } else {
        fail(buffers[k].where(), "has no data");
      }
      const double length = buffers[k].member("byteLength").number();
      if (!(length >= 0) || length > static_cast<double>(b.bytes.size())) {
        fail(buffers[k].where() + "/byteLength",
             "there are only " + std::to_string(b.bytes.size()) + " bytes");
      }
    } catch (const GltfFault& f) {
      b.fault = f.what();
    }
  }
}

bool Buffers::has_data(const Value& reference) const {
  const Value accessors = document_.member("accessors");
  const Value a = accessors[reference.index(accessors.size(), "accessor")];
  return a.member("bufferView").there() || a.member("sparse").there();
}

/// A file of a few bytes may ask for the same accessor, or for zeros, again and again.
void Buffers::spend(const Value& accessor, double numbers) const {
  constexpr double kMostNumbers = 5e7;
  spent_ += numbers;
  if (spent_ > kMostNumbers) fail(accessor.where(), "more than fifty million numbers are read from the file");
}

std::vector<double> Buffers::read(const Rows& rows) const {
  const Value views = document_.member("bufferViews");
  const Value view = views[rows.view.index(views.size(), "buffer view")];
  const Buffer& buffer = buffers_[view.member("buffer").index(buffers_.size(), "buffer")];
  require_sound(buffer.fault);
  const double offset = view.member("byteOffset").number_or(0);
  const double inside = rows.holder.member("byteOffset").number_or(0);
  const double length = view.member("byteLength").number();
  const size_t size = size_of(rows.component, rows.holder.member("componentType"));
  const double row = static_cast<double>(size * rows.columns);
  double stride = rows.strided ? view.member("byteStride").number_or(row) : row;
  if (stride == 0) stride = row;
  if (!(offset >= 0) || !(inside >= 0) || !(length >= 0) ||
      offset + length > static_cast<double>(buffer.bytes.size())) {
    fail(view.where(), "reaches beyond its buffer of " + std::to_string(buffer.bytes.size()) + " bytes");
  }
  if (!(stride >= row) || stride != std::floor(stride) || inside != std::floor(inside) ||
      offset != std::floor(offset) ||
      inside + (static_cast<double>(rows.count) - 1) * stride + row > length) {
    fail(rows.holder.where(),
         "reaches beyond its buffer view of " + std::to_string(static_cast<size_t>(length)) + " bytes");
  }
  std::vector<double> out;
  out.reserve(rows.count * rows.columns);
  const std::byte* at = buffer.bytes.data() + static_cast<size_t>(offset) + static_cast<size_t>(inside);
  for (size_t r = 0; r < rows.count; ++r) {
    for (size_t c = 0; c < rows.columns; ++c) {
      const std::byte* p = at + r * static_cast<size_t>(stride) + c * size;
      const double x = component_at(p, rows.component, rows.normalised);
      if (!(std::abs(x) <= kMostValue)) {
        fail(rows.holder.where(), "element " + std::to_string(r) + " is not finite or too large");
      }
      out.push_back(x);
    }
  }
  return out;
}

void Buffers::read_sparse(const Value& accessor, Rows rows, std::vector<double>& out) const {
  const Value sparse = accessor.member("sparse"), at = sparse.member("indices"),
              values = sparse.member("values");
  const size_t all = rows.count, count = count_of(sparse.member("count"));
  if (count > all) fail(sparse.where() + "/count", "is more than the accessor has");
  const auto kind = static_cast<int>(at.member("componentType").number());
  const std::vector<double> places = read({at.member("bufferView"), at, kind, false, 1, count, false});
  rows.view = values.member("bufferView"), rows.holder = values, rows.count = count, rows.strided = false;
  const std::vector<double> given = read(rows);
  for (size_t k = 0; k < count; ++k) {
    if (!(places[k] >= 0 && places[k] < static_cast<double>(all)) || places[k] != std::floor(places[k]) ||
        (k > 0 && !(places[k] > places[k - 1]))) {
      fail(at.where(), "element " + std::to_string(k) + " is not an index above the one before and below " +
                           std::to_string(all));
    }
    std::copy_n(&given[k * rows.columns], rows.columns, &out[static_cast<size_t>(places[k]) * rows.columns]);
  }
}

std::vector<double> Buffers::numbers(const Value& reference, size_t width) const {
  const Value accessors = document_.member("accessors");
  const Value a = accessors[reference.index(accessors.size(), "accessor")];
  const size_t columns = columns_of(a.member("type"), width);
  const auto component = static_cast<int>(a.member("componentType").number());
  size_of(component, a.member("componentType"));
  const size_t count = count_of(a.member("count"));
  const Rows rows{a.member("bufferView"), a, component, a.member("normalized").flag(), columns, count, true};
  std::vector<double> out;
  if (rows.view.there()) out = read(rows);
  spend(a, static_cast<double>(count) * static_cast<double>(columns));
  // Nothing in the file bounds the number of zeros.
  if (!rows.view.there()) out.resize(count * columns);
  if (a.member("sparse").there()) read_sparse(a, rows, out);
  return out;
}

std::vector<Vec3> Buffers::vectors(const Value& reference) const {
  const std::vector<double> all = numbers(reference, 3);
  std::vector<Vec3> out(all.size() / 3);
  for (size_t k = 0; k < out.size(); ++k) out[k] = {all[3 * k], all[3 * k + 1], all[3 * k + 2]};
  return out;
}

}  // namespace truestep::gltf
