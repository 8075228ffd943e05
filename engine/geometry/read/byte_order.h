// Numbers from bytes in either byte order.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace truestep {

enum class ByteOrder : bool { little, big };

/// sizeof(T) bytes at `from`.
template <class T>
T load_number(const char* from, ByteOrder order) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  const bool native = (order == ByteOrder::little) == (std::endian::native == std::endian::little);
  if (!native) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

}  // namespace truestep
