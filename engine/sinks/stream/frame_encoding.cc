#include "engine/sinks/stream/frame_encoding.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "engine/base/errors.h"

namespace truestep {

static_assert(std::endian::native == std::endian::little, "the wire format is the memory's own");

namespace {

// --- protobuf wire format: https://protobuf.dev/programming-guides/encoding (varints, fixed, lengths)

constexpr uint32_t tag(uint32_t field, uint32_t wire_type) {
  return field << 3 | wire_type;
}

void put_varint(std::string& out, uint64_t v) {
  while (v >= 0x80) {
    out.push_back(static_cast<char>(v | 0x80));
    v >>= 7;
  }
  out.push_back(static_cast<char>(v));
}
template <class T>
void put_raw(std::string& out, T v) {
  char bytes[sizeof v];
  std::memcpy(bytes, &v, sizeof v);
  out.append(bytes, sizeof v);
}
void put_integer(std::string& out, uint32_t field, uint64_t v) {
  if (v == 0) return;
  put_varint(out, tag(field, 0));
  put_varint(out, v);
}
void put_double(std::string& out, uint32_t field, double v) {
  if (v == 0) return;
  put_varint(out, tag(field, 1));
  put_raw(out, v);
}
void put_bytes(std::string& out, uint32_t field, std::string_view v) {
  if (v.empty()) return;
  put_varint(out, tag(field, 2));
  put_varint(out, v.size());
  out.append(v);
}
void put_doubles(std::string& out, uint32_t field, std::span<const double> v) {
  if (v.empty()) return;
  put_varint(out, tag(field, 2));
  put_varint(out, v.size() * 8);
  for (const double x : v) put_raw(out, x);
}
size_t varint_size(uint64_t v) {
  size_t n = 1;
  for (; v >= 0x80; v >>= 7) ++n;
  return n;
}

// 16 bits per element between the least and greatest value of each component.
struct Quantized {
  std::vector<double> offset, scale;
  std::string data;
};

Quantized quantize(const FrameBlock& block) {
  Quantized q;
  const auto* v = reinterpret_cast<const float*>(block.data.data());
  const uint32_t w = block.width;
  q.offset.assign(w, 0);
  q.scale.assign(w, 0);
  for (uint32_t c = 0; c < w && block.rows > 0; ++c) {
    float low = v[c], high = v[c];
    for (size_t i = 1; i < block.rows; ++i) {
      low = std::min(low, v[i * w + c]);
      high = std::max(high, v[i * w + c]);
    }
    q.offset[c] = low;
    q.scale[c] = (static_cast<double>(high) - low) / 65535;
  }
  q.data.resize(block.rows * w * 2);
  for (size_t i = 0; i < block.rows; ++i) {
    for (uint32_t c = 0; c < w; ++c) {
      const double scaled = q.scale[c] > 0 ? (v[i * w + c] - q.offset[c]) / q.scale[c] : 0;
      const auto element = static_cast<uint16_t>(std::clamp(scaled + 0.5, 0.0, 65535.0));
      std::memcpy(&q.data[2 * (i * w + c)], &element, 2);
    }
  }
  return q;
}

const FrameBlock& block_of(const Frame& frame, const WireField& field) {
  const FrameBlock* block = frame.find(field.key);
  if (!block) throw Error("internal", "the frame does not hold field " + field.name);
  return *block;
}

std::string_view view_of(const FrameBlock& block) {
  return {reinterpret_cast<const char*>(block.data.data()), block.data.size()};
}

void append_number(std::string& out, double v) {
  if (!std::isfinite(v)) {
    out += "null";
    return;
  }
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v).ptr;
  out.append(text, end);
}
void append_number(std::string& out, float v) {
  if (!std::isfinite(v)) {
    out += "null";
    return;
  }
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v).ptr;
  out.append(text, end);
}
void append_number(std::string& out, uint64_t v) {
  out += std::to_string(v);
}
void append_number(std::string& out, uint32_t v) {
  out += std::to_string(v);
}
void append_number(std::string& out, int32_t v) {
  out += std::to_string(v);
}

// Rows of width 1 are plain numbers, wider ones are arrays.
template <class T>
void append_rows(std::string& out, const FrameBlock& block) {
  const auto* v = reinterpret_cast<const T*>(block.data.data());
  out += '[';
  for (size_t i = 0; i < block.rows; ++i) {
    if (i) out += ',';
    if (block.width > 1) out += '[';
    for (uint32_t c = 0; c < block.width; ++c) {
      if (c) out += ',';
      append_number(out, v[i * block.width + c]);
    }
    if (block.width > 1) out += ']';
  }
  out += ']';
}

void append_rows(std::string& out, const FrameBlock& block) {
  switch (block.key.type) {
    case Scalar::f64:
      return append_rows<double>(out, block);
    case Scalar::f32:
      return append_rows<float>(out, block);
    case Scalar::i32:
      return append_rows<int32_t>(out, block);
    case Scalar::u32:
      return append_rows<uint32_t>(out, block);
    case Scalar::u64:
      return append_rows<uint64_t>(out, block);
  }
}

}  // namespace

std::vector<WireField> wire_fields(const World& world, const std::vector<std::string>& fields,
                                   const std::vector<std::string>& systems, WireEncoding wish) {
  const std::vector<std::string> wanted = fields.empty() ? std::vector<std::string>{"position"} : fields;
  for (const std::string& id : systems) world.index_of(id);
  std::vector<WireField> out;
  std::string known;
  std::vector<bool> found(wanted.size());
  for (size_t s = 0; s < world.size(); ++s) {
    if (!systems.empty() && std::find(systems.begin(), systems.end(), world.id(s)) == systems.end()) continue;
    const auto infos = world.system(s).fields();
    for (size_t f = 0; f < infos.size(); ++f) {
      if (known.find(infos[f].name) == std::string::npos)
        known += (known.empty() ? "" : ", ") + infos[f].name;
      for (size_t w = 0; w < wanted.size(); ++w) {
        if (wanted[w] != infos[f].name) continue;
        found[w] = true;
        WireField field{{static_cast<uint32_t>(s), static_cast<uint32_t>(f), infos[f].type},
                        wish,
                        world.id(s),
                        infos[f].name,
                        infos[f].unit,
                        infos[f].width};
        if (infos[f].type == Scalar::f64) {
          field.key.type = wish == WireEncoding::f64 ? Scalar::f64 : Scalar::f32;
        } else if (infos[f].type == Scalar::f32) {
          if (wish == WireEncoding::f64) field.encoding = WireEncoding::f32;
        } else {
          field.encoding = WireEncoding::u32;
        }
        out.push_back(std::move(field));
      }
    }
  }
  for (size_t w = 0; w < wanted.size(); ++w) {
    if (!found[w]) {
      throw Error("bad_request", "no system has a field named " + wanted[w].substr(0, 64),
                  {{"/fields/" + std::to_string(w), "unknown_field", "no system has this field",
                    '"' + wanted[w].substr(0, 64) + '"', known, "", ""}});
    }
  }
  return out;
}

FrameRequest request_for(std::span<const WireField> fields, FrameRequest::Extras extras) {
  FrameRequest r;
  for (const WireField& f : fields) r.fields.push_back(f.key);
  std::sort(r.fields.begin(), r.fields.end());
  r.fields.erase(std::unique(r.fields.begin(), r.fields.end()), r.fields.end());
  r.extras = extras;
  return r;
}

std::shared_ptr<const std::string> encode_blocks(const Frame& frame, std::span<const WireField> fields) {
  auto out = std::make_shared<std::string>();
  size_t total = 0;
  for (const WireField& f : fields) total += block_of(frame, f).data.size() + 128;
  out->reserve(total);
  for (const WireField& f : fields) {
    const FrameBlock& block = block_of(frame, f);
    Quantized q;
    std::string_view data = view_of(block);
    if (f.encoding == WireEncoding::q16) {
      q = quantize(block);
      data = q.data;
    }
    std::string head;
    put_bytes(head, 1, f.system);
    put_bytes(head, 2, f.name);
    put_integer(head, 3, static_cast<uint64_t>(f.encoding));
    put_doubles(head, 4, q.offset);
    put_doubles(head, 5, q.scale);
    put_integer(head, 6, block.rows);
    put_integer(head, 7, block.width);
    const size_t data_size = data.empty() ? 0 : 1 + varint_size(data.size()) + data.size();
    put_varint(*out, tag(9, 2));
    put_varint(*out, head.size() + data_size);
    out->append(head);
    put_bytes(*out, 8, data);
  }
  return out;
}

std::string encode_frame_fields(const Frame& frame, uint64_t seq, uint64_t dropped) {
  std::string out;
  put_integer(out, 1, seq);
  put_integer(out, 2, frame.step);
  put_double(out, 3, frame.time);
  put_varint(out, tag(4, 1));
  put_raw(out, frame.state_hash);
  put_integer(out, 5, dropped);
  put_integer(out, 6, frame.topology_version);
  put_integer(out, 7, 1);
  put_double(out, 10, frame.alpha);
  return out;
}

std::string encode_head(const Frame& frame, uint64_t seq, uint64_t dropped, size_t block_bytes) {
  const std::string fields = encode_frame_fields(frame, seq, dropped);
  std::string out;
  put_varint(out, tag(3, 2));  // ServerMessage.frame
  put_varint(out, fields.size() + block_bytes);
  return out + fields;
}

std::string encode_json(const Frame& frame, std::span<const WireField> fields) {
  std::string out = "{\"step\":" + std::to_string(frame.step) + ",\"time\":";
  append_number(out, frame.time);
  out += ",\"alpha\":";
  append_number(out, frame.alpha);
  out += ",\"state_hash\":\"" + hex64(frame.state_hash) +
         "\",\"topology_version\":" + std::to_string(frame.topology_version) + ",\"blocks\":[";
  for (size_t k = 0; k < fields.size(); ++k) {
    const WireField& f = fields[k];
    const FrameBlock& block = block_of(frame, f);
    // Ids, field names and units hold no character that JSON escapes.
    out += std::string(k ? "," : "") + "{\"system\":\"" + f.system + "\",\"field\":\"" + f.name +
           "\",\"unit\":\"" + f.unit + "\",\"count\":" + std::to_string(block.rows) +
           ",\"width\":" + std::to_string(block.width) + ",\"values\":";
    append_rows(out, block);
    out += '}';
  }
  out += ']';
  if (!frame.observables.rows().empty()) {
    out += ",\"observables\":{";
    for (size_t k = 0; k < frame.observables.rows().size(); ++k) {
      const Observation& o = frame.observables.rows()[k];
      out += std::string(k ? "," : "") + '"' + o.name + "\":";
      append_number(out, o.value);
    }
    out += '}';
  }
  out += '}';
  return out;
}

}  // namespace truestep
