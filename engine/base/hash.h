// 64-bit content hashes (XXH3). Equal bytes give equal hashes on every machine; -0.0 counts as 0.0.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace truestep {

/// Streaming hash: feed in a fixed order, then take `value`.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;
  void bytes(const void* data, size_t size);
  void text(std::string_view s);  ///< length, then bytes
  void integer(uint64_t v);
  void doubles(std::span<const double> v);  ///< -0.0 hashed as +0.0
  void floats(std::span<const float> v);    ///< -0.0 hashed as +0.0
  uint64_t value() const;

 private:
  void* state_;
};

/// 16 lower-case hexadecimal digits.
std::string hex64(uint64_t v);

}  // namespace truestep
