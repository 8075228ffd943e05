// UTF-8 validation that can be fed in pieces (RFC 3629: no overlong forms, no surrogates, nothing above
// U+10FFFF). Used by the JSON reader, by the WebSocket text messages and by request targets.
#pragma once
#include <cstdint>
#include <string_view>

namespace truestep {

/// Validates a byte sequence that may arrive in pieces split anywhere.
class Utf8Validator {
 public:
  /// Takes more bytes; false as soon as no continuation can make the sequence valid.
  bool feed(std::string_view bytes);
  /// True when the bytes so far end on a character boundary.
  bool complete() const { return need_ == 0; }
  void reset() { need_ = 0; }

 private:
  uint8_t need_ = 0;    ///< continuation bytes still missing
  uint8_t low_ = 0x80;  ///< bounds of the next continuation byte
  uint8_t high_ = 0xBF;
};

/// True when the whole text is valid UTF-8.
bool valid_utf8(std::string_view text);

/// Offset of the first byte of the first invalid sequence, or npos when the text is valid.
size_t find_invalid_utf8(std::string_view text);

/// Appends one code point (at most U+10FFFF, no surrogate) as UTF-8.
template <class String>
void append_utf8(String& out, uint32_t c) {
  if (c < 0x80) {
    out.push_back(static_cast<char>(c));
  } else if (c < 0x800) {
    out.push_back(static_cast<char>(0xC0 | c >> 6));
    out.push_back(static_cast<char>(0x80 | (c & 0x3F)));
  } else if (c < 0x10000) {
    out.push_back(static_cast<char>(0xE0 | c >> 12));
    out.push_back(static_cast<char>(0x80 | (c >> 6 & 0x3F)));
    out.push_back(static_cast<char>(0x80 | (c & 0x3F)));
  } else {
    out.push_back(static_cast<char>(0xF0 | c >> 18));
    out.push_back(static_cast<char>(0x80 | (c >> 12 & 0x3F)));
    out.push_back(static_cast<char>(0x80 | (c >> 6 & 0x3F)));
    out.push_back(static_cast<char>(0x80 | (c & 0x3F)));
  }
}

}  // namespace truestep
