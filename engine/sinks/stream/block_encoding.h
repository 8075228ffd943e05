// One Block of stream.proto: a field's values of one frame as bytes. Here are the encodings that need nothing
// but the frame itself; delta_coder.h holds the one that needs what the client has.
#pragma once
#include <string>
#include <string_view>

#include "engine/sinks/stream/frame_encoding.h"
#include "engine/sinks/stream/quantise.h"

namespace truestep {

/// How values of a type go as they are.
WireEncoding plain_encoding(Scalar type);
/// The frame's values of a field. Error "internal" when the frame does not hold them.
const FrameBlock& block_of(const Frame& frame, const WireField& field);
/// The values of a block of type f32.
const float* floats_of(const FrameBlock& block);

/// Appends a Block as it stands in a Frame message; `box` is empty for encodings without offset and scale.
void append_block(std::string& out, const WireField& field, const FrameBlock& block, WireEncoding encoding,
                  const QuantumBox& box, std::string_view data);
/// The same from the values themselves: as Q16 or QUAT32 where the field asks for it and every value can be
/// carried (finite; quaternions not zero), otherwise the values as they are. Q16_DELTA becomes Q16.
void append_block(std::string& out, const WireField& field, const FrameBlock& block);

}  // namespace truestep
