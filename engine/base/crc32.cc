#include "engine/base/crc32.h"

#include <array>
#include <cstring>

namespace truestep {

namespace {

// Eight tables: table[k][b] advances byte b by k more zero bytes.
constexpr std::array<std::array<uint32_t, 256>, 8> make_tables() {
  std::array<std::array<uint32_t, 256>, 8> t{};
  for (uint32_t b = 0; b < 256; ++b) {
    uint32_t c = b;
    for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320u ^ (c >> 1) : c >> 1;
    t[0][b] = c;
  }
  for (uint32_t b = 0; b < 256; ++b) {
    for (size_t k = 1; k < 8; ++k) t[k][b] = t[0][t[k - 1][b] & 255] ^ (t[k - 1][b] >> 8);
  }
  return t;
}
constexpr auto kTables = make_tables();

}  // namespace

uint32_t crc32(uint32_t before, const void* data, size_t size) {
  const auto* p = static_cast<const unsigned char*>(data);
  uint32_t c = ~before;
  for (; size >= 8; size -= 8, p += 8) {
    uint64_t w;
    std::memcpy(&w, p, 8);
    w ^= c;
    c = 0;
    for (size_t k = 0; k < 8; ++k) c ^= kTables[7 - k][w >> (8 * k) & 255];
  }
  for (; size > 0; --size, ++p) c = kTables[0][(c ^ *p) & 255] ^ (c >> 8);
  return ~c;
}

}  // namespace truestep
