// How finely a system's parameters divide its object, and how they change when the same object is divided
// more finely. Convergence in space and run time against error over resolution follow from it.
#pragma once
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

struct Resolution {
  std::string_view parameter;  ///< as scenes name it: "cells"
  /// Changes the system's def to the same object divided `factor` times as finely along each direction (a
  /// power of two, also below 1), or says why that is impossible: counts that would not be whole, or
  /// parameters that belong to points instead of the object.
  std::optional<std::string> (*divide)(void* def, double factor);
  /// Order of the spatial error that this def promises; 0: none.
  int (*order)(const void* def);
  /// Where the rows of `part` lie in the undeformed object: the same place at every resolution, in any unit.
  /// Null: the part is a grid.
  std::vector<Vec3> (*places)(const void* def) = nullptr;
  /// The part on which resolutions are compared: one whose rows are at the same places at all of them.
  size_t part = 0;
};

/// Multiplies a number of cells or links by a factor; false, and nothing changes, if the result is not a
/// whole number from `least` to `most`.
template <class Count>
bool divided(Count& count, double factor, double least, double most) {
  const double wanted = factor * static_cast<double>(count);
  if (wanted != std::floor(wanted) || !(wanted >= least && wanted <= most)) return false;
  count = static_cast<Count>(wanted);
  return true;
}

}  // namespace truestep
