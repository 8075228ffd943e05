#include "engine/sinks/stream/frame_encoding.h"

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/sinks/stream/block_encoding.h"
#include "engine/sinks/stream/wire_format.h"

namespace truestep {

namespace {

// Rotations have an encoding of their own: QUAT32 wherever small frames were asked for.
bool is_rotation(const FieldInfo& info) {
  return info.name == "orientation" && info.width == 4;
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
        const Scalar type = infos[f].type;
        const WireEncoding encoding = encoding_of(infos[f], wish);
        const bool narrow = type == Scalar::f64 && encoding != WireEncoding::f64;
        out.push_back({{static_cast<uint32_t>(s), static_cast<uint32_t>(f), narrow ? Scalar::f32 : type},
                       encoding,
                       world.id(s),
                       infos[f].name,
                       infos[f].unit,
                       infos[f].width});
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
  put_integer(out, 6, frame.topology_version);
  put_integer(out, 7, place.base_seq == 0 ? 1 : 0);
  put_integer(out, 8, place.base_seq);
  put_double(out, 10, frame.alpha);
  return out;
}

std::string encode_head(const Frame& frame, const StreamPlace& place, size_t block_bytes) {
  const std::string fields = encode_frame_fields(frame, place);
  std::string out;
  wire::put_tag(out, 3, wire::length);  // ServerMessage.frame
  wire::put_varint(out, fields.size() + block_bytes);
  return out + fields;
}

}  // namespace truestep
