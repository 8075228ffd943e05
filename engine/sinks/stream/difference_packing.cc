#include "engine/sinks/stream/difference_packing.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace truestep {

namespace {

constexpr size_t kLanes = 16;
constexpr size_t kEntries = 16;  // per lane of a full group
constexpr size_t kGroup = kLanes * kEntries;

// One vector register of 16-bit lanes; compilers turn each operation into one instruction, or several
// narrower ones.
typedef uint16_t Lanes __attribute__((vector_size(2 * kLanes)));
typedef int16_t SignedLanes __attribute__((vector_size(2 * kLanes)));

Lanes load(const uint16_t* p) {
  Lanes v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

Lanes zigzag(Lanes now, Lanes base) {
  const auto d = reinterpret_cast<SignedLanes>(now - base);
  return reinterpret_cast<Lanes>((d << 1) ^ (d >> 15));
}

unsigned bits_of(Lanes all) {
  unsigned any = 0;
  for (size_t l = 0; l < kLanes; ++l) any |= all[l];
  return static_cast<unsigned>(std::bit_width(any));
}

// Writes the entries' words; `to` has room for kEntries words a lane.
size_t pack_entries(const Lanes* z, size_t entries, unsigned bits, char* to) {
  if (bits == 0) return 0;
  Lanes word{};
  uint16_t filled = 0;
  size_t size = 0;
  for (size_t j = 0; j < entries; ++j) {
    word |= z[j] << filled;
    filled = static_cast<uint16_t>(filled + bits);
    if (filled < 16) continue;
    std::memcpy(to + size, &word, sizeof word);
    size += sizeof word;
    filled = static_cast<uint16_t>(filled - 16);
    word = filled > 0 ? z[j] >> static_cast<uint16_t>(bits - filled) : Lanes{};
  }
  if (filled > 0) {
    std::memcpy(to + size, &word, sizeof word);
    size += sizeof word;
  }
  return size;
}

// The group that starts at `first`: in place when complete, otherwise in `copy`, padded with zeros.
const uint16_t* group_of(std::span<const uint16_t> values, size_t first, std::array<uint16_t, kGroup>& copy) {
  if (first + kGroup <= values.size()) return values.data() + first;
  copy.fill(0);
  if (first < values.size())
    std::copy(values.begin() + static_cast<ptrdiff_t>(first), values.end(), copy.begin());
  return copy.data();
}

}  // namespace

void pack_differences(std::span<const uint16_t> now, std::span<const uint16_t> base, std::string& out) {
  const size_t groups = (now.size() + kGroup - 1) / kGroup;
  const size_t head = (groups + 3) / 4 * 4;
  const size_t begin = out.size();
  out.resize(begin + head + 2 * kGroup * groups);
  char* to = out.data() + begin + head;
  std::array<Lanes, kEntries> z;
  for (size_t g = 0; g < groups; ++g) {
    const size_t first = g * kGroup;
    const size_t count = std::min(kGroup, now.size() - first);
    const size_t entries = (count + kLanes - 1) / kLanes;
    std::array<uint16_t, kGroup> now_copy, base_copy;
    const uint16_t* a = group_of(now, first, now_copy);
    const uint16_t* b = group_of(base.first(std::min(base.size(), now.size())), first, base_copy);
    Lanes all{};
    for (size_t j = 0; j < entries; ++j) {
      z[j] = zigzag(load(a + j * kLanes), load(b + j * kLanes));
      all |= z[j];
    }
    const unsigned bits = bits_of(all);
    out[begin + g] = static_cast<char>(bits);
    to += pack_entries(z.data(), entries, bits, to);
  }
  out.resize(static_cast<size_t>(to - out.data()));
}

}  // namespace truestep
