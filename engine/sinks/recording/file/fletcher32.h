// Fletcher-32 as HDF5's filter defines it: words of 16 bits taken big-endian, two running sums modulo 65535,
//   s1 = sum_i w_i,   s2 = sum_i (n - i) w_i,   checksum = s2 << 16 | s1   (a non-zero multiple of 65535 is
//   65535).
// Source: J. Fletcher, IEEE Trans. Communications 30 (1982) 247; HDF5 file format specification, filter 3.
// Our own, because the library's processes one word at a time, which costs more than writing the data.
#pragma once
#include <cstddef>
#include <cstdint>

namespace truestep {

/// Checksum of `size` bytes, equal to the one HDF5's Fletcher32 filter appends (as little-endian u32) to a
/// chunk.
uint32_t fletcher32(const void* data, size_t size);

}  // namespace truestep
