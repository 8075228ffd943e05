// Differences of 16-bit values, packed in as few bits as each group needs (the bytes of a Q16_DELTA block).
//   d = now - base mod 2^16, z = 2 d for d >= 0, -2 d - 1 for d < 0 (as int16), b = bits of the greatest z
// Layout, little-endian: one byte b (0 ... 16) per group of 256 values, zeros up to a multiple of 4, then the
// groups. A group is 16 lanes side by side; value 16 j + l of the group is entry j of lane l, and a lane is
// one string of b-bit entries, lowest bit first, in ceil(b * entries / 16) 16-bit words. Word w of lane l is
// the group's word 16 w + l. Entries beyond the last value are 0. A value that the base does not have counts
// as 0 there. (Bit packing by lanes: D. Lemire, L. Boytsov, Decoding billions of integers per second, 2015.)
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace truestep {

/// Appends the packed differences of `now` to `base`; base may have fewer or more values.
void pack_differences(std::span<const uint16_t> now, std::span<const uint16_t> base, std::string& out);

}  // namespace truestep
