// One Block of stream.proto: a field's values in one frame as bytes. These are the encodings that need only
// the frame itself; delta_coder.h has the one that depends on what the client holds.
#pragma once
#include <string>
#include <string_view>

#include "engine/sinks/stream/frame_encoding.h"
#include "engine/sinks/stream/quantise.h"

namespace truestep {

/// The encoding for values of a type without conversion.
WireEncoding plain_encoding(Scalar type);
/// The frame's values of a field. Error "internal" when the frame does not have them.
const FrameBlock& block_of(const Frame& frame, const WireField& field);
/// The values of a block of type f32.
const float* floats_of(const FrameBlock& block);

/// Appends a Block as in a Frame message; `box` is empty for encodings without offset and scale.
void append_block(std::string& out, const WireField& field, const FrameBlock& block, WireEncoding encoding,
                  const QuantumBox& box, std::string_view data);
/// The same from the values themselves: as Q16 or QUAT32 if the field asks for it and every value can be
/// represented (finite; quaternions not zero), otherwise unconverted. Q16_DELTA becomes Q16.
void append_block(std::string& out, const WireField& field, const FrameBlock& block);

}  // namespace truestep
