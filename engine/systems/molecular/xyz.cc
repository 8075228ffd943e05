#include "engine/systems/molecular/xyz.h"

#include <cmath>

#include "engine/geometry/read/text_lines.h"
#include "engine/systems/molecular/xyz_comment.h"

namespace truestep::molecular {
namespace {

/// The words of a line of an atom as far as they are needed; false when one is missing.
bool take_words(TextLines& lines, size_t last, std::vector<std::string_view>& words) {
  words.clear();
  while (words.size() <= last) {
    words.push_back(lines.word());
    if (words.back().empty()) return false;
  }
  return true;
}

std::string name_of(std::string_view word, bool number, size_t line) {
  if (!number) return std::string(word);
  double z = 0;
  const bool whole = read_double(word, z) && z >= 1 && z < 1000 && z == std::floor(z);
  const std::string_view symbol = whole ? element_symbol(static_cast<size_t>(z)) : std::string_view{};
  if (symbol.empty()) throw XyzFault(line, quoted(word) + " is not an atomic number");
  return std::string(symbol);
}

size_t read_count(TextLines& lines) {
  double count = 0;
  if (!lines.next() || !read_double(lines.word(), count) || count != std::floor(count))
    throw XyzFault(1, "expected the number of atoms");
  if (!(count >= 1 && count <= static_cast<double>(kMostXyzAtoms))) {
    throw XyzFault(1, "the number of atoms must be from 1 to " + std::to_string(kMostXyzAtoms));
  }
  return static_cast<size_t>(count);
}

std::string_view read_comment(TextLines& lines) {
  return lines.next() ? lines.whole() : std::string_view{};
}

}  // namespace

XyzAtoms read_xyz(std::string_view text) {
  TextLines lines(text);
  const size_t count = read_count(lines);
  const XyzColumns columns = xyz_columns(read_comment(lines));
  const size_t last = std::max(columns.name, columns.position + 2);
  XyzAtoms out;
  std::vector<std::string_view> words;
  for (size_t i = 0; i < count; ++i) {
    const size_t number = i + 3;
    if (!lines.next()) {
      throw XyzFault(number,
                     "the text ends after " + std::to_string(i) + " of " + std::to_string(count) + " atoms");
    }
    if (!take_words(lines, last, words)) {
      throw XyzFault(number, words.size() == 1 ? "expected a name and three coordinates"
                             : last == 3       ? "expected three finite coordinates after the name"
                                               : "expected " + std::to_string(last + 1) + " columns or more");
    }
    double at[3];
    for (size_t c = 0; c < 3; ++c) {
      if (!read_double(words[columns.position + c], at[c]) || !std::isfinite(at[c])) {
        throw XyzFault(number, last == 3 ? "expected three finite coordinates after the name"
                                         : quoted(words[columns.position + c]) + " is not a coordinate");
      }
    }
    out.names.push_back(name_of(words[columns.name], columns.number, number));
    out.positions.push_back({at[0], at[1], at[2]});
  }
  return out;
}

XyzLattice read_xyz_lattice(std::string_view text) {
  TextLines lines(text);
  read_count(lines);
  return xyz_lattice(read_comment(lines));
}

}  // namespace truestep::molecular
