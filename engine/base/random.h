// Counter-based random numbers: Philox4x32-10 (Salmon, Moraes, Dror, Shaw 2011, "Parallel random numbers:
// as easy as 1, 2, 3", algorithm of section 3). A draw is a pure function of (seed, stream, counter), so
// there is no generator to save and any thread may draw any number. Not for cryptography.
#pragma once
#include <array>
#include <cstdint>

namespace truestep {

/// Ten rounds of Philox on a 128-bit counter under a 64-bit key.
constexpr std::array<uint32_t, 4> philox4x32(std::array<uint32_t, 4> c, std::array<uint32_t, 2> k) {
  for (int round = 0; round < 10; ++round) {
    const uint64_t p0 = uint64_t{0xD2511F53} * c[0], p1 = uint64_t{0xCD9E8D57} * c[2];
    c = {static_cast<uint32_t>(p1 >> 32) ^ c[1] ^ k[0], static_cast<uint32_t>(p1),
         static_cast<uint32_t>(p0 >> 32) ^ c[3] ^ k[1], static_cast<uint32_t>(p0)};
    k[0] += 0x9E3779B9;
    k[1] += 0xBB67AE85;
  }
  return c;
}

/// Four uniform numbers in [0, 1) with 32 random bits each, for draw `counter` of `stream`.
constexpr std::array<double, 4> uniform4(uint64_t seed, uint64_t stream, uint64_t counter) {
  const auto r = philox4x32({static_cast<uint32_t>(counter), static_cast<uint32_t>(counter >> 32),
                             static_cast<uint32_t>(stream), static_cast<uint32_t>(stream >> 32)},
                            {static_cast<uint32_t>(seed), static_cast<uint32_t>(seed >> 32)});
  return {r[0] * 0x1p-32, r[1] * 0x1p-32, r[2] * 0x1p-32, r[3] * 0x1p-32};
}

}  // namespace truestep
