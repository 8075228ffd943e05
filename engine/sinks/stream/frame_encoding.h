// Frames on the wire (proto/truestep/v1/stream.proto). The blocks of a frame are encoded once and shared by
// every client that asked for the same; only a short head (sequence number, drops) is made for each client.
// Parts of a protobuf message can simply be concatenated, so head and blocks never meet in memory.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/session/world/frame.h"
#include "engine/session/world/world.h"

namespace truestep {

/// As Encoding in stream.proto.
enum class WireEncoding : uint8_t {
  f32 = 0,
  f64 = 1,
  q16 = 2,
  q16_delta = 3,
  quat32 = 4,
  u32 = 5,
  u64 = 6,
  i32 = 7
};

/// One block to send: which field, and how.
struct WireField {
  FieldKey key;  ///< key.type is the type that the frame must hold
  WireEncoding encoding = WireEncoding::f32;
  std::string system, name;  ///< ids of part and field as they appear on the wire
  std::string unit;
  uint32_t width = 1;
  friend bool operator==(const WireField&, const WireField&) = default;
};

/// Fields by name (empty: positions of points, the first field of a grid), systems or single parts by id
/// (empty: all), in the requested encoding of floating-point fields: with Q16_DELTA, orientations (w x y z)
/// are sent as QUAT32; with QUAT32, everything else is sent as F32. Error "bad_request" listing the
/// alternatives when a name is unknown.
std::vector<WireField> wire_fields(const World& world, const std::vector<std::string>& fields,
                                   const std::vector<std::string>& parts, WireEncoding wish);
/// What a session must put into its frames for these fields.
FrameRequest request_for(std::span<const WireField> fields, FrameRequest::Extras extras);

/// Bytes of repeated Block; shared between clients.
std::shared_ptr<const std::string> encode_blocks(const Frame& frame, std::span<const WireField> fields);
/// The position of a frame in one client's stream.
struct StreamPlace {
  uint64_t seq = 0, dropped = 0;
  uint64_t base_seq = 0;  ///< the frame that Q16_DELTA blocks refer to; 0: none, a key frame
};
/// Everything in a ServerMessage{frame} except the blocks, which must follow these bytes; `more` are further
/// encoded fields of the Frame.
std::string encode_head(const Frame& frame, const StreamPlace& place, std::string_view more,
                        size_t block_bytes);
/// The fields of a Frame message except its blocks; a Frame's bytes are these and encode_blocks concatenated.
std::string encode_frame_fields(const Frame& frame, const StreamPlace& place);
/// The frame as JSON with arrays of numbers, for polling clients. Numbers that are not finite are null.
std::string encode_json(const Frame& frame, std::span<const WireField> fields);

}  // namespace truestep
