// The comment of an extended XYZ text: key=value, values in quotes or braces where they have blanks.
#pragma once
#include <cstddef>
#include <string_view>

#include "engine/systems/molecular/xyz.h"

namespace truestep::molecular {

/// Where a line of an atom has what is read, counted in words from 0.
struct XyzColumns {
  size_t name = 0, position = 1;
  bool number = false;  ///< the name is an atomic number
};

/// The value of a key, without regard to upper and lower case; nothing without the key.
std::optional<std::string_view> xyz_value(std::string_view comment, std::string_view key);
/// As `Properties` says, or those of the plain format. Throws XyzFault.
XyzColumns xyz_columns(std::string_view comment);
XyzLattice xyz_lattice(std::string_view comment);
/// The symbol of an element; empty for a number that none has.
std::string_view element_symbol(size_t atomic_number);

}  // namespace truestep::molecular
