#include "engine/geometry/read/text_lines.h"

#include <charconv>
#include <cmath>
#include <utility>

#include "engine/base/text/encoding.h"

namespace truestep {

namespace {

constexpr std::string_view kBlanks = " \t\r\f\v";

}  // namespace

std::string quoted(std::string_view word) {
  constexpr size_t kMost = 40;
  std::string out = "\"";
  for (const char c : word.substr(0, kMost)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (word.size() > kMost ? "...\"" : "\"");
}

bool read_double(std::string_view word, double& out) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const size_t fortran = word.find_first_of("dD");
  if (fortran != word.npos && word.size() < 40) {
    std::string plain(word);
    plain[fortran] = 'e';
    return plain.find_first_of("dD") == plain.npos && read_double(plain, out);
  }
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
  if (error == std::errc::result_out_of_range && end == word.data() + word.size()) {
    // Too small to be distinguished from 0, or too large for a double.
    const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
    out = tiny ? 0 : HUGE_VAL;
    return true;
  }
  return error == std::errc() && end == word.data() + word.size() && !word.empty();
}

bool same_word(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  if (a.size() != b.size()) return false;
  for (size_t k = 0; k < a.size(); ++k) {
    if (lower(a[k]) != lower(b[k])) return false;
  }
  return true;
}

TextLines::TextLines(std::string_view text) : text_(without_byte_order_mark(text)) {
  const size_t end = text_.find_first_of("\r\n");
  const bool alone =
      end != text_.npos && text_[end] == '\r' && end + 1 < text_.size() && text_[end + 1] != '\n';
  if (alone) ending_ = '\r';
}

bool TextLines::next() {
  if (text_.empty()) {
    if (!std::exchange(ended_, true)) ++line_;
    rest_ = {};
    return false;
  }
  ++line_;
  const size_t end = text_.find(ending_);
  rest_ = text_.substr(0, end);
  text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
  return true;
}

bool TextLines::next_filled() {
  while (next()) {
    if (!peek().empty()) return true;
  }
  return false;
}

std::string_view TextLines::peek() const {
  const size_t begin = rest_.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  const std::string_view from = rest_.substr(begin);
  return from.substr(0, from.find_first_of(kBlanks));
}

std::string_view TextLines::word() {
  const std::string_view out = peek();
  if (out.empty()) {
    rest_ = {};
  } else {
    rest_.remove_prefix(static_cast<size_t>(out.data() + out.size() - rest_.data()));
  }
  return out;
}

std::string_view TextLines::next_word() {
  while (peek().empty()) {
    if (!next()) return {};
  }
  return word();
}

std::string_view TextLines::rest() const {
  const size_t begin = rest_.find_first_not_of(kBlanks), end = rest_.find_last_not_of(kBlanks);
  return begin == std::string_view::npos ? std::string_view{} : rest_.substr(begin, end + 1 - begin);
}

void TextLines::fail(const std::string& message) const {
  throw MeshFault(MeshFault::Unit::line, std::max<size_t>(1, line_), message);
}

double TextLines::coordinate(const char* what) {
  const std::string_view w = word();
  double out = 0;
  if (w.empty()) fail(std::string(what) + " is missing");
  if (!read_double(w, out)) fail(quoted(w) + " instead of " + what);
  if (!(std::abs(out) <= kMostFileCoordinate))
    fail(quoted(w) + " is not a coordinate: use a number of at most 1e12");
  return out;
}

int64_t TextLines::integer(const char* what, int64_t least, int64_t most) {
  std::string_view w = word();
  if (w.empty()) fail(std::string(what) + " is missing");
  const std::string_view whole = w;
  if (w.starts_with('+')) w.remove_prefix(1);
  int64_t out = 0;
  const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), out);
  if (error != std::errc() || end != w.data() + w.size())
    fail(quoted(whole) + " instead of " + what + ", a whole number");
  if (out < least || out > most) {
    fail(std::string(what) + " is " + std::to_string(out) + ": from " + std::to_string(least) + " to " +
         std::to_string(most) + " are possible");
  }
  return out;
}

}  // namespace truestep
