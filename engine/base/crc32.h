// CRC-32 (ISO 3309, as in zip and PNG), eight bytes at a time.
#pragma once
#include <cstddef>
#include <cstdint>

namespace truestep {

/// CRC-32 of `size` bytes that follow those with CRC `before` (0 at the start).
uint32_t crc32(uint32_t before, const void* data, size_t size);

}  // namespace truestep
