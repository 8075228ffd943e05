#include "engine/systems/molecular/xyz_comment.h"

#include <cmath>

#include "engine/geometry/read/text_lines.h"

namespace truestep::molecular {
namespace {

constexpr size_t kCommentLine = 2;
constexpr std::string_view kSymbols[] = {
    "H",  "He", "Li", "Be", "B",  "C",  "N",  "O",  "F",  "Ne", "Na", "Mg", "Al", "Si", "P",  "S",  "Cl",
    "Ar", "K",  "Ca", "Sc", "Ti", "V",  "Cr", "Mn", "Fe", "Co", "Ni", "Cu", "Zn", "Ga", "Ge", "As", "Se",
    "Br", "Kr", "Rb", "Sr", "Y",  "Zr", "Nb", "Mo", "Tc", "Ru", "Rh", "Pd", "Ag", "Cd", "In", "Sn", "Sb",
    "Te", "I",  "Xe", "Cs", "Ba", "La", "Ce", "Pr", "Nd", "Pm", "Sm", "Eu", "Gd", "Tb", "Dy", "Ho", "Er",
    "Tm", "Yb", "Lu", "Hf", "Ta", "W",  "Re", "Os", "Ir", "Pt", "Au", "Hg", "Tl", "Pb", "Bi", "Po", "At",
    "Rn", "Fr", "Ra", "Ac", "Th", "Pa", "U",  "Np", "Pu", "Am", "Cm", "Bk", "Cf", "Es", "Fm", "Md", "No",
    "Lr", "Rf", "Db", "Sg", "Bh", "Hs", "Mt", "Ds", "Rg", "Cn", "Nh", "Fl", "Mc", "Lv", "Ts", "Og"};

[[noreturn]] void fail(const std::string& what) {
  throw XyzFault(kCommentLine, what);
}

/// A key with its value off the front of the comment; false at its end.
bool take_entry(std::string_view& text, std::string_view& key, std::string_view& value) {
  constexpr std::string_view kBlanks = " \t\r";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  if (text.empty()) return false;
  const size_t end = std::min(text.find_first_of(" \t\r="), text.size());
  key = text.substr(0, end), value = {};
  text.remove_prefix(std::max<size_t>(end, text[0] == '=' ? 1 : 0));
  if (!text.starts_with('=')) return true;
  text.remove_prefix(1);
  constexpr std::string_view kOpen = "\"'{[", kClose = "\"'}]";
  const size_t quote = text.empty() ? kOpen.npos : kOpen.find(text[0]);
  if (quote == kOpen.npos) {
    value = text.substr(0, text.find_first_of(kBlanks));
    text.remove_prefix(value.size());
    return true;
  }
  text.remove_prefix(1);
  value = text.substr(0, text.find(kClose[quote]));
  text.remove_prefix(std::min(value.size() + 1, text.size()));
  return true;
}

/// Takes a part up to the separator.
std::string_view take_part(std::string_view& text, char separator) {
  const std::string_view out = text.substr(0, text.find(separator));
  text.remove_prefix(std::min(out.size() + 1, text.size()));
  return out;
}

}  // namespace

std::optional<std::string_view> xyz_value(std::string_view comment, std::string_view key) {
  std::string_view k, v;
  while (take_entry(comment, k, v)) {
    if (same_word(k, key) && v.data() != nullptr) return v;
  }
  return std::nullopt;
}

XyzColumns xyz_columns(std::string_view comment) {
  const auto properties = xyz_value(comment, "Properties");
  if (!properties) return {};
  constexpr size_t kAbsent = static_cast<size_t>(-1);
  size_t species = kAbsent, z = kAbsent, position = kAbsent, at = 0;
  std::string_view rest = *properties;
  while (!rest.empty()) {
    const std::string_view name = take_part(rest, ':'), type = take_part(rest, ':'),
                           columns = take_part(rest, ':');
    double count = 0;
    if (!read_double(columns, count) || !(count >= 1 && count <= 1000) || count != std::floor(count) ||
        (type != "S" && type != "R" && type != "I" && type != "L")) {
      fail("Properties must be name:type:columns with the types S, R, I and L, not " + quoted(*properties));
    }
    if (same_word(name, "species") || same_word(name, "element")) species = at;
    if (name == "Z" || name == "numbers") z = at;
    if (same_word(name, "pos") || same_word(name, "positions")) {
      if (count != 3) fail("Properties gives pos " + quoted(columns) + " columns: it needs three");
      position = at;
    }
    at += static_cast<size_t>(count);
  }
  if (position == kAbsent) fail("Properties has no pos:R:3, the coordinates");
  if (species == kAbsent && z == kAbsent) fail("Properties has neither species:S:1 nor Z:I:1, the kinds");
  return {species != kAbsent ? species : z, position, species == kAbsent};
}

XyzLattice xyz_lattice(std::string_view comment) {
  const auto lattice = xyz_value(comment, "Lattice");
  if (!lattice) return std::nullopt;
  if (const auto pbc = xyz_value(comment, "pbc")) {
    TextLines words(*pbc);
    size_t yes = 0, no = 0;
    for (std::string_view w = words.next_word(); !w.empty(); w = words.next_word()) {
      (same_word(w, "T") || same_word(w, "true") || w == "1" ? yes : no) += 1;
    }
    if (yes + no != 3 || (yes != 0 && no != 0))
      fail("pbc is " + quoted(*pbc) + ": the sides are periodic in all three directions or in none");
    if (yes == 0) return std::nullopt;
  }
  TextLines words(*lattice);
  double x[9];
  for (double& v : x) {
    const std::string_view w = words.next_word();
    if (!read_double(w, v) || !std::isfinite(v)) fail("Lattice must have nine numbers, three vectors");
  }
  if (!words.next_word().empty()) fail("Lattice must have nine numbers, three vectors");
  return std::array{Vec3{x[0], x[1], x[2]}, Vec3{x[3], x[4], x[5]}, Vec3{x[6], x[7], x[8]}};
}

std::string_view element_symbol(size_t atomic_number) {
  return atomic_number >= 1 && atomic_number <= std::size(kSymbols) ? kSymbols[atomic_number - 1]
                                                                    : std::string_view{};
}

}  // namespace truestep::molecular
