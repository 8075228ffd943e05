#include "engine/sinks/recording/file/superblock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "engine/sinks/recording/file/plain_file.h"

namespace truestep {
namespace {

constexpr unsigned char kSignature[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
constexpr size_t kSize = 48;  // with 8-byte offsets
constexpr size_t kVersionAt = 8, kOffsetSizeAt = 9, kFlagsAt = 11, kEndAt = 28, kChecksumAt = 44;

void mix(uint32_t& a, uint32_t& b, uint32_t& c) {
  a -= c, a ^= std::rotl(c, 4), c += b;
  b -= a, b ^= std::rotl(a, 6), a += c;
  c -= b, c ^= std::rotl(b, 8), b += a;
  a -= c, a ^= std::rotl(c, 16), c += b;
  b -= a, b ^= std::rotl(a, 19), a += c;
  c -= b, c ^= std::rotl(b, 4), b += a;
}

void final_mix(uint32_t& a, uint32_t& b, uint32_t& c) {
  c ^= b, c -= std::rotl(b, 14);
  a ^= c, a -= std::rotl(c, 11);
  b ^= a, b -= std::rotl(a, 25);
  c ^= b, c -= std::rotl(b, 16);
  a ^= c, a -= std::rotl(c, 4);
  b ^= a, b -= std::rotl(a, 14);
  c ^= b, c -= std::rotl(b, 24);
}

}  // namespace

uint32_t lookup3(const void* data, size_t size) {
  const auto* p = static_cast<const unsigned char*>(data);
  uint32_t a = 0xdeadbeefu + static_cast<uint32_t>(size), b = a, c = a;
  // Three words a round; the last round takes 1 to 12 bytes, missing ones count as zero.
  for (; size > 12; size -= 12, p += 12) {
    uint32_t w[3];
    std::memcpy(w, p, 12);
    a += w[0], b += w[1], c += w[2];
    mix(a, b, c);
  }
  if (size == 0) return c;
  uint32_t w[3] = {0, 0, 0};
  std::memcpy(w, p, size);
  a += w[0], b += w[1], c += w[2];
  final_mix(a, b, c);
  return c;
}

bool repair_superblock(std::span<std::byte> start, uint64_t end) {
  if (start.size() < kSize) return false;
  auto* block = reinterpret_cast<unsigned char*>(start.data());
  const bool known =
      std::equal(kSignature, kSignature + 8, block) && block[kVersionAt] == 3 && block[kOffsetSizeAt] == 8;
  if (!known) return false;
  block[kFlagsAt] = 0;
  std::memcpy(block + kEndAt, &end, 8);
  const uint32_t sum = lookup3(block, kChecksumAt);
  std::memcpy(block + kChecksumAt, &sum, 4);
  return true;
}

bool repair_superblock(const std::string& path) {
  const int file = open_plainly(path, O_RDWR);
  if (file < 0) return false;
  std::array<std::byte, kSize> block;
  struct stat about {};
  const bool done = ::fstat(file, &about) == 0 && ::pread(file, block.data(), kSize, 0) == ssize_t{kSize} &&
                    repair_superblock(block, static_cast<uint64_t>(about.st_size)) &&
                    ::pwrite(file, block.data(), kSize, 0) == ssize_t{kSize};
  ::close(file);
  return done;
}

}  // namespace truestep
