#include "engine/systems/molecular/xyz.h"

#include <charconv>
#include <cmath>

namespace truestep::molecular {
namespace {

/// Takes a line off the text.
std::string_view take_line(std::string_view& text) {
  const size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

/// Takes a word off the line; empty when there is none left.
std::string_view take_word(std::string_view& line) {
  const size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  line.remove_prefix(begin);
  const size_t end = std::min(line.find_first_of(" \t"), line.size());
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(end);
  return word;
}

template <class T>
bool read_number(std::string_view word, T& out) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
  return error == std::errc() && end == word.data() + word.size() && !word.empty();
}

}  // namespace

XyzAtoms read_xyz(std::string_view text) {
  std::string_view line = take_line(text);
  size_t count = 0;
  if (!read_number(take_word(line), count)) throw XyzFault(1, "expected the number of atoms");
  if (count == 0 || count > kMostXyzAtoms) {
    throw XyzFault(1, "the number of atoms must be from 1 to " + std::to_string(kMostXyzAtoms));
  }
  take_line(text);
  XyzAtoms out;
  for (size_t i = 0; i < count; ++i) {
    const size_t number = i + 3;
    if (text.empty()) {
      throw XyzFault(number,
                     "the text ends after " + std::to_string(i) + " of " + std::to_string(count) + " atoms");
    }
    line = take_line(text);
    const std::string_view name = take_word(line);
    if (name.empty()) throw XyzFault(number, "expected a name and three coordinates");
    double at[3];
    for (double& c : at) {
      if (!read_number(take_word(line), c) || !std::isfinite(c)) {
        throw XyzFault(number, "expected three finite coordinates after the name");
      }
    }
    out.names.emplace_back(name);
    out.positions.push_back({at[0], at[1], at[2]});
  }
  return out;
}

}  // namespace truestep::molecular
