// Hash of one contiguous range of bytes, without the allocation of a Hasher: for checking within a step
// whether something has changed.
#pragma once
#include <cstddef>
#include <cstdint>

namespace truestep {

/// 64 bits (XXH3), continuing from `before`.
uint64_t byte_hash(const void* data, size_t size, uint64_t before = 0);

}  // namespace truestep
