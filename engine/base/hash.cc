#include "engine/base/hash.h"

#include <xxhash.h>

#include <algorithm>
#include <new>

namespace truestep {

namespace {
// Adding +0.0 maps -0.0 to +0.0 and leaves every other value alone.
template <class T>
void feed_canonical(XXH3_state_t* state, std::span<const T> values) {
  T buffer[512];
  for (size_t begin = 0; begin < values.size(); begin += 512) {
    const size_t n = std::min<size_t>(512, values.size() - begin);
    for (size_t i = 0; i < n; ++i) buffer[i] = values[begin + i] + T(0);
    XXH3_64bits_update(state, buffer, n * sizeof(T));
  }
}
XXH3_state_t* as_state(void* p) {
  return static_cast<XXH3_state_t*>(p);
}
}  // namespace

Hasher::Hasher() : state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_64bits_reset(as_state(state_));
}
Hasher::~Hasher() {
  XXH3_freeState(as_state(state_));
}
void Hasher::bytes(const void* data, size_t size) {
  if (size) XXH3_64bits_update(as_state(state_), data, size);
}
void Hasher::text(std::string_view s) {
  integer(s.size());
  bytes(s.data(), s.size());
}
void Hasher::integer(uint64_t v) {
  bytes(&v, sizeof v);
}
void Hasher::doubles(std::span<const double> v) {
  feed_canonical(as_state(state_), v);
}
void Hasher::floats(std::span<const float> v) {
  feed_canonical(as_state(state_), v);
}
uint64_t Hasher::value() const {
  return XXH3_64bits_digest(as_state(state_));
}

std::string hex64(uint64_t v) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string s(16, '0');
  for (int i = 15; i >= 0; --i, v >>= 4) s[static_cast<size_t>(i)] = kDigits[v & 15];
  return s;
}

}  // namespace truestep
