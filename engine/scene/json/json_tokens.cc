#include "engine/scene/json/json_tokens.h"

#include <algorithm>
#include <charconv>

#include "engine/base/errors.h"
#include "engine/base/text/utf8.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_habits.h"

namespace truestep {
namespace {

namespace json = boost::json;

// Bytes that end a run of plain string characters: quote, backslash, controls, and everything above ASCII.
constexpr bool is_plain(unsigned char c) {
  return c >= 0x20 && c < 0x80 && c != '"' && c != '\\';
}

// Line and column, counted from 1, of the text after `before`; columns count characters.
std::string place_of(std::string_view before) {
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::string_view rest = before.substr(before.rfind('\n') + 1);
  const auto starts = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
  const auto column = 1 + std::count_if(rest.begin(), rest.end(), starts);
  return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

}  // namespace

void JsonTokens::fail_at(const char* where, const char* code, const std::string& what) {
  std::string pointer;
  for (const Step& s : path_) {
    if (s.key.data()) {
      append_pointer(pointer, {s.key.data(), s.key.size()});
    } else {
      pointer += '/';
      pointer += std::to_string(s.index);
    }
  }
  if (!valid_utf8(pointer)) pointer.clear();
  const auto offset = static_cast<size_t>(where - begin_);
  Issue issue;
  issue.pointer = pointer;
  issue.code = code;
  const std::string_view all(begin_, static_cast<size_t>(end_ - begin_));
  std::string habit;
  if (issue.code == "syntax") habit = foreign_notation(all.substr(0, offset), all.substr(offset));
  issue.message = (habit.empty() ? what : habit) + " (" + place_of({begin_, offset}) + ", byte " +
                  std::to_string(offset) + ")";
  std::string_view near(where, std::min<size_t>(20, static_cast<size_t>(end_ - where)));
  near = near.substr(0, std::min({near.size(), find_invalid_utf8(near), near.find_first_of("\r\n")}));
  issue.value = std::string(near);
  // Excessive depth is a limit of this service, not a syntax error.
  const bool limit = std::string_view(code) == "too_deep";
  throw Error(limit ? "too_large" : "bad_json", "not valid JSON: " + issue.message, {issue});
}

void JsonTokens::literal(std::string_view word) {
  if (std::string_view(p_, std::min(word.size(), static_cast<size_t>(end_ - p_))) != word) {
    fail("syntax", "neither true, false, null, a number, a string, an array nor an object");
  }
  p_ += word.size();
}

std::string_view JsonTokens::read_string() {
  const char* start = ++p_;
  bool ascii = true;
  p_ = plain_run(p_, ascii);
  if (p_ != end_ && *p_ == '"') {
    const std::string_view s(start, static_cast<size_t>(p_ - start));
    check_utf8(s, ascii);
    ++p_;
    return s;
  }
  scratch_.assign(start, static_cast<size_t>(p_ - start));
  for (;;) {
    if (p_ == end_) fail("syntax", "the text ends inside a string");
    const auto c = static_cast<unsigned char>(*p_);
    if (c == '"') break;
    if (c < 0x20) fail("syntax", "a control character inside a string must be escaped");
    const char* run = p_;
    if (c == '\\') {
      read_escape();
    } else {
      p_ = plain_run(p_, ascii);
      scratch_.append(run, static_cast<size_t>(p_ - run));
    }
  }
  check_utf8({start, static_cast<size_t>(p_ - start)}, ascii);
  ++p_;
  return scratch_;
}

const char* JsonTokens::plain_run(const char* p, bool& ascii) const {
  for (; p != end_; ++p) {
    const auto c = static_cast<unsigned char>(*p);
    if (is_plain(c)) continue;
    if (c < 0x80) break;
    ascii = false;
  }
  return p;
}

void JsonTokens::check_utf8(std::string_view s, bool ascii) {
  if (ascii || valid_utf8(s)) return;
  fail_at(s.data() + find_invalid_utf8(s), "bad_utf8", "a string is not valid UTF-8");
}

void JsonTokens::read_escape() {
  const char* start = p_++;
  if (p_ == end_) fail("syntax", "the text ends inside a string");
  switch (*p_++) {
    case '"':
      scratch_ += '"';
      return;
    case '\\':
      scratch_ += '\\';
      return;
    case '/':
      scratch_ += '/';
      return;
    case 'b':
      scratch_ += '\b';
      return;
    case 'f':
      scratch_ += '\f';
      return;
    case 'n':
      scratch_ += '\n';
      return;
    case 'r':
      scratch_ += '\r';
      return;
    case 't':
      scratch_ += '\t';
      return;
    case 'u':
      break;
    default:
      fail_at(start, "syntax", "unknown escape in a string");
  }
  uint32_t c = hex4(start);
  if (c >= 0xDC00 && c <= 0xDFFF) fail_at(start, "lone_surrogate", "a low surrogate without its high one");
  if (c >= 0xD800 && c <= 0xDBFF) {
    if (end_ - p_ < 2 || p_[0] != '\\' || p_[1] != 'u')
      fail_at(start, "lone_surrogate", "a high surrogate without its low one");
    p_ += 2;
    const uint32_t low = hex4(start);
    if (low < 0xDC00 || low > 0xDFFF)
      fail_at(start, "lone_surrogate", "a high surrogate without its low one");
    c = 0x10000 + ((c - 0xD800) << 10) + (low - 0xDC00);
  }
  append_utf8(scratch_, c);
}

uint32_t JsonTokens::hex4(const char* start) {
  uint32_t v = 0;
  if (end_ - p_ < 4) fail_at(start, "syntax", "\\u needs four hexadecimal digits");
  const auto r = std::from_chars(p_, p_ + 4, v, 16);
  if (r.ec != std::errc() || r.ptr != p_ + 4) fail_at(start, "syntax", "\\u needs four hexadecimal digits");
  p_ += 4;
  return v;
}

bool JsonTokens::digits() {
  const char* start = p_;
  while (p_ != end_ && *p_ >= '0' && *p_ <= '9') ++p_;
  return p_ != start;
}

void JsonTokens::read_number(json::value& out) {
  const char* start = p_;
  const bool negative = *p_ == '-';
  if (negative) ++p_;
  const char* first = p_;
  if (!digits())
    fail_at(start, "syntax", "neither true, false, null, a number, a string, an array nor an object");
  if (*first == '0' && p_ - first > 1) fail_at(start, "syntax", "a number starts with an unnecessary zero");
  bool integer = true;
  if (p_ != end_ && *p_ == '.') {
    integer = false;
    ++p_;
    if (!digits()) fail("syntax", "expected a digit after the decimal point");
  }
  if (p_ != end_ && (*p_ == 'e' || *p_ == 'E')) {
    integer = false;
    ++p_;
    if (p_ != end_ && (*p_ == '+' || *p_ == '-')) ++p_;
    if (!digits()) fail("syntax", "expected a digit in the exponent");
  }
  if (integer && read_integer(out, start, negative)) return;
  double v = 0;
  const auto r = std::from_chars(start, p_, v);
  if (r.ec == std::errc::result_out_of_range) {
    // Underflow gives zero as in other readers; overflow has no value at all.
    if (!underflows(first)) fail_at(start, "number_overflow", "a number is beyond the range of a double");
    v = negative ? -0.0 : 0.0;
  }
  out = v;
}

bool JsonTokens::read_integer(json::value& out, const char* start, bool negative) {
  if (negative) {
    int64_t v = 0;
    if (std::from_chars(start, p_, v).ec != std::errc()) return false;
    out = v;
    return true;
  }
  uint64_t v = 0;
  if (std::from_chars(start, p_, v).ec != std::errc()) return false;
  if (v <= static_cast<uint64_t>(INT64_MAX)) {
    out = static_cast<int64_t>(v);
  } else {
    out = v;
  }
  return true;
}

// Whether a number known to be out of range is below the smallest double rather than above the largest. Uses
// the decimal exponent of the first non-zero digit, saturating.
bool JsonTokens::underflows(const char* p) const {
  long long position = 0;
  bool seen_point = false, seen_digit = false;
  for (; p != p_ && *p != 'e' && *p != 'E'; ++p) {
    if (*p == '.') {
      seen_point = true;
    } else if (seen_digit) {
      position += seen_point ? 0 : 1;
    } else if (*p != '0') {
      seen_digit = true;
      position -= seen_point ? 1 : 0;
    } else {
      position -= seen_point ? 1 : 0;
    }
  }
  long long exponent = 0;
  if (p != p_) {
    ++p;
    const bool minus = *p == '-';
    if (*p == '+' || *p == '-') ++p;
    for (; p != p_; ++p) exponent = std::min(exponent * 10 + (*p - '0'), 1000000000000ll);
    if (minus) exponent = -exponent;
  }
  return position + exponent < 0;
}

}  // namespace truestep
