// A layout as bytes and back, for the chunk log: what is needed to make a file again without anything from
// the damaged one. Little-endian; texts and lists carry their length. The path is left out.
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/sinks/recording/file/layout.h"

namespace truestep {

std::vector<std::byte> layout_bytes(const RecordingLayout& layout);

/// Empty when the bytes are not a valid layout.
std::optional<RecordingLayout> layout_from_bytes(std::span<const std::byte> bytes);

}  // namespace truestep
