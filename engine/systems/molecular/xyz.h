// Atoms in the text format XYZ: a line with their number, a line of comment, then a line per atom with a name
// and three coordinates; anything after them on a line, and lines after the last atom, are ignored. Extended
// XYZ (the comment as key=value, as ASE and OVITO write it): `Properties` says which columns name the atoms
// (species, or Z as an atomic number) and place them (pos), `Lattice` and `pbc` the periodic box; all other
// keys and columns are ignored.
#pragma once
#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep::molecular {

struct XyzAtoms {
  std::vector<std::string> names;
  std::vector<Vec3> positions;  ///< in the text's own unit
};

/// The periodic box of a text that says that it is periodic in all directions: its edges as vectors.
using XyzLattice = std::optional<std::array<Vec3, 3>>;

/// What is wrong, with the line number, from 1.
struct XyzFault : std::runtime_error {
  XyzFault(size_t at, const std::string& what) : std::runtime_error(what), line(at) {}
  size_t line;
};

/// Maximum number of atoms in a text.
inline constexpr size_t kMostXyzAtoms = 1'000'000;
XyzAtoms read_xyz(std::string_view text);
/// Reads no further than the comment. Throws XyzFault when it is periodic in some directions only.
XyzLattice read_xyz_lattice(std::string_view text);

}  // namespace truestep::molecular
