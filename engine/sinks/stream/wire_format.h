// Protobuf's wire format, written by hand where a message is mostly one array: varints, fixed, lengths
// (https://protobuf.dev/programming-guides/encoding). A field that holds its default is not written.
#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace truestep::wire {

static_assert(std::endian::native == std::endian::little, "the wire format is the memory's own");

enum WireType : uint32_t { varint = 0, fixed64 = 1, length = 2 };

inline void put_varint(std::string& out, uint64_t v) {
  while (v >= 0x80) {
    out.push_back(static_cast<char>(v | 0x80));
    v >>= 7;
  }
  out.push_back(static_cast<char>(v));
}
inline void put_tag(std::string& out, uint32_t field, WireType type) {
  put_varint(out, field << 3 | type);
}
template <class T>
void put_raw(std::string& out, T v) {
  char bytes[sizeof v];
  std::memcpy(bytes, &v, sizeof v);
  out.append(bytes, sizeof v);
}
inline void put_integer(std::string& out, uint32_t field, uint64_t v) {
  if (v == 0) return;
  put_tag(out, field, varint);
  put_varint(out, v);
}
inline void put_double(std::string& out, uint32_t field, double v) {
  if (v == 0) return;
  put_tag(out, field, fixed64);
  put_raw(out, v);
}
inline void put_bytes(std::string& out, uint32_t field, std::string_view v) {
  if (v.empty()) return;
  put_tag(out, field, length);
  put_varint(out, v.size());
  out.append(v);
}
inline void put_doubles(std::string& out, uint32_t field, std::span<const double> v) {
  if (v.empty()) return;
  put_tag(out, field, length);
  put_varint(out, v.size() * 8);
  for (const double x : v) put_raw(out, x);
}
inline size_t varint_size(uint64_t v) {
  size_t n = 1;
  for (; v >= 0x80; v >>= 7) ++n;
  return n;
}

}  // namespace truestep::wire
