// Frames on the wire (proto/truestep/v1/stream.proto). The blocks of a frame are encoded once and shared by
// every client that asked for the same; only a short head (sequence number, drops) is made for each. A
// protobuf message may come in parts whose bytes are simply joined, so head and blocks never meet in memory.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/session/frame.h"
#include "engine/session/world.h"

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
  FieldKey key;  ///< key.type is what the frame must hold
  WireEncoding encoding = WireEncoding::f32;
  std::string system, name;  ///< ids of part and field as they appear on the wire
  std::string unit;
  uint32_t width = 1;
  friend bool operator==(const WireField&, const WireField&) = default;
};

/// Fields by name (empty: places of points, the first field of a grid), systems or single parts by id (empty:
/// all), in the encoding wished for floating-point fields: with Q16_DELTA orientations (w x y z) go as
/// QUAT32, with QUAT32 everything else goes as F32. Error "bad_request" with what there is when a name is
/// unknown.
std::vector<WireField> wire_fields(const World& world, const std::vector<std::string>& fields,
                                   const std::vector<std::string>& parts, WireEncoding wish);
/// What a session must put into its frames for these.
FrameRequest request_for(std::span<const WireField> fields, FrameRequest::Extras extras);

/// Bytes of repeated Block; shared between clients.
std::shared_ptr<const std::string> encode_blocks(const Frame& frame, std::span<const WireField> fields);
/// Where a frame stands in one client's stream.
struct StreamPlace {
  uint64_t seq = 0, dropped = 0;
  uint64_t base_seq = 0;  ///< the frame that Q16_DELTA blocks refer to; 0: none, a key frame
};
/// Everything of a ServerMessage{frame} but the blocks, which must follow these bytes; `more` are further
/// encoded fields of the Frame.
std::string encode_head(const Frame& frame, const StreamPlace& place, std::string_view more,
                        size_t block_bytes);
/// The fields of a Frame message but its blocks; a Frame's bytes are these and encode_blocks joined.
std::string encode_frame_fields(const Frame& frame, const StreamPlace& place);
/// The frame as JSON with arrays of numbers, as polling clients get it. A number that is not finite is null.
std::string encode_json(const Frame& frame, std::span<const WireField> fields);

}  // namespace truestep
