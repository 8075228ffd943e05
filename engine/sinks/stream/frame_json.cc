// A frame as JSON with arrays of numbers, each in the shortest text that reads back as the same number.
#include <charconv>
#include <cmath>
#include <concepts>

#include "engine/base/hash.h"
#include "engine/sinks/stream/block_encoding.h"
#include "engine/sinks/stream/frame_encoding.h"

namespace truestep {

namespace {

// The shortest text that reads back as the same number.
template <class T>
void append_number(std::string& out, T v) {
  if constexpr (std::floating_point<T>) {
    if (!std::isfinite(v)) {
      out += "null";
      return;
    }
  }
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, v).ptr);
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

std::string encode_json(const Frame& frame, std::span<const WireField> fields) {
  std::string out = "{\"step\":" + std::to_string(frame.step) + ",\"time\":";
  append_number(out, frame.time);
  out += ",\"alpha\":";
  append_number(out, frame.alpha);
  if (frame.state_hash) out += ",\"state_hash\":\"" + hex64(*frame.state_hash) + '"';
  out += ",\"topology_version\":" + std::to_string(frame.drawing_version) + ",\"blocks\":[";
  for (size_t k = 0; k < fields.size(); ++k) {
    const WireField& f = fields[k];
    const FrameBlock& block = block_of(frame, f);
    // Ids, field names and units contain no character that JSON escapes.
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
