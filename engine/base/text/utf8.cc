// UTF-8 validation, byte ranges from table 3-7 of the Unicode standard.
#include "engine/base/text/utf8.h"

#include <cstring>

namespace truestep {
namespace {

// Length of the run of ASCII bytes at the front, eight at a time.
size_t ascii_prefix(const char* p, size_t n) {
  size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    uint64_t word;
    std::memcpy(&word, p + i, 8);
    if (word & 0x8080808080808080ull) break;
  }
  while (i < n && static_cast<unsigned char>(p[i]) < 0x80) ++i;
  return i;
}

}  // namespace

bool Utf8Validator::feed(std::string_view bytes) {
  const char* p = bytes.data();
  const size_t n = bytes.size();
  for (size_t i = 0; i < n;) {
    if (need_ == 0) {
      i += ascii_prefix(p + i, n - i);
      if (i == n) return true;
      const auto c = static_cast<unsigned char>(p[i++]);
      low_ = 0x80;
      high_ = 0xBF;
      if (c >= 0xC2 && c <= 0xDF) {
        need_ = 1;
      } else if (c >= 0xE0 && c <= 0xEF) {
        need_ = 2;
        if (c == 0xE0) low_ = 0xA0;   // shorter forms exist
        if (c == 0xED) high_ = 0x9F;  // surrogates
      } else if (c >= 0xF0 && c <= 0xF4) {
        need_ = 3;
        if (c == 0xF0) low_ = 0x90;   // shorter forms exist
        if (c == 0xF4) high_ = 0x8F;  // above U+10FFFF
      } else {
        return false;
      }
    } else {
      const auto c = static_cast<unsigned char>(p[i++]);
      if (c < low_ || c > high_) return false;
      low_ = 0x80;
      high_ = 0xBF;
      --need_;
    }
  }
  return true;
}

bool valid_utf8(std::string_view text) {
  Utf8Validator v;
  return v.feed(text) && v.complete();
}

size_t find_invalid_utf8(std::string_view text) {
  // Only called on text known to be short or broken: walk character by character.
  size_t i = 0;
  while (i < text.size()) {
    i += ascii_prefix(text.data() + i, text.size() - i);
    if (i == text.size()) break;
    size_t length = 1;
    for (; length <= 4 && i + length <= text.size(); ++length) {
      if (valid_utf8(text.substr(i, length))) break;
    }
    if (length > 4 || i + length > text.size()) return i;
    i += length;
  }
  return std::string_view::npos;
}

}  // namespace truestep
