#include "engine/sinks/stream/frame_encoding.h"

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/scene/params/params_text.h"
#include "engine/sinks/stream/block_encoding.h"
#include "engine/sinks/stream/wire_format.h"

namespace truestep {

namespace {

// Rotations have an encoding of their own: QUAT32 whenever small frames are requested.
bool is_rotation(const FieldInfo& info) {
  return info.meaning == Meaning::orientation && info.width == 4;
}

WireEncoding encoding_of(const FieldInfo& info, WireEncoding wish) {
  if (info.type != Scalar::f64 && info.type != Scalar::f32) return plain_encoding(info.type);
  switch (wish) {
    case WireEncoding::f64:
      return info.type == Scalar::f64 ? WireEncoding::f64 : WireEncoding::f32;
    case WireEncoding::q16_delta:
      return is_rotation(info) ? WireEncoding::quat32 : WireEncoding::q16_delta;
    case WireEncoding::quat32:
      return is_rotation(info) ? WireEncoding::quat32 : WireEncoding::f32;
    default:
      return wish;
  }
}

void require_part(const PartTable& table, const std::string& name) {
  for (size_t p = 0; p < table.size(); ++p) {
    if (table.named(p, name)) return;
  }
  throw Error("unknown_system", "no system has the id \"" + name.substr(0, 64) + '"',
              {"/system", "unknown_system", "no system or part has this id", '"' + name.substr(0, 64) + '"',
               join_names(table.ids()), "", ""});
}

}  // namespace

std::vector<WireField> wire_fields(const World& world, const std::vector<std::string>& fields,
                                   const std::vector<std::string>& parts, WireEncoding wish) {
  const PartTable& table = world.parts();
  std::vector<WireField> out;
  const auto take = [&](size_t p, size_t f) {
    const FieldInfo& info = table[p].info().fields[f];
    const WireEncoding encoding = encoding_of(info, wish);
    const bool narrow = info.type == Scalar::f64 && encoding != WireEncoding::f64;
    out.push_back({{static_cast<uint32_t>(p), static_cast<uint32_t>(f), narrow ? Scalar::f32 : info.type},
                   encoding,
                   table[p].id,
                   info.name,
                   info.unit,
                   info.width});
  };
  for (const std::string& name : parts) require_part(table, name);
  std::vector<bool> found(fields.size());
  for (size_t p = 0; p < table.size(); ++p) {
    const auto means = [&](const std::string& name) { return table.named(p, name); };
    if (!parts.empty() && std::none_of(parts.begin(), parts.end(), means)) continue;
    const PartInfo& part = table[p].info();
    if (fields.empty()) {
      // The main visible fields: positions of points, contents of a grid.
      if (part.kind == PartInfo::Kind::grid) take(p, 0);
      if (const auto f = part.find(Meaning::position)) take(p, *f);
      continue;
    }
    for (size_t f = 0; f < part.fields.size(); ++f) {
      const auto at = std::find(fields.begin(), fields.end(), part.fields[f].name);
      if (at == fields.end()) continue;
      found[static_cast<size_t>(at - fields.begin())] = true;
      take(p, f);
    }
  }
  for (size_t w = 0; w < fields.size(); ++w) {
    if (found[w] || std::find(fields.begin(), fields.begin() + static_cast<ptrdiff_t>(w), fields[w]) !=
                        fields.begin() + static_cast<ptrdiff_t>(w))
      continue;
    throw Error("bad_request", "no system has a field named " + fields[w].substr(0, 64),
                {"/fields/" + std::to_string(w), "unknown_field", "no system has this field",
                 '"' + fields[w].substr(0, 64) + '"', join_names(table.field_names("")), "", ""});
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
  for (const WireField& f : fields) append_block(*out, f, block_of(frame, f));
  return out;
}

std::string encode_frame_fields(const Frame& frame, const StreamPlace& place) {
  using namespace wire;
  std::string out;
  put_integer(out, 1, place.seq);
  put_integer(out, 2, frame.step);
  put_double(out, 3, frame.time);
  if (frame.state_hash) put_tag(out, 4, fixed64), put_raw(out, *frame.state_hash);
  put_integer(out, 5, place.dropped);
  put_integer(out, 6, frame.drawing_version);
  put_integer(out, 7, place.base_seq == 0 ? 1 : 0);
  put_integer(out, 8, place.base_seq);
  put_double(out, 10, frame.alpha);
  return out;
}

std::string encode_head(const Frame& frame, const StreamPlace& place, std::string_view more,
                        size_t block_bytes) {
  const std::string fields = encode_frame_fields(frame, place) + std::string(more);
  std::string out;
  wire::put_tag(out, 3, wire::length);  // ServerMessage.frame
  wire::put_varint(out, fields.size() + block_bytes);
  return out + fields;
}

}  // namespace truestep
