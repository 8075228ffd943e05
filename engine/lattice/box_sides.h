// The conditions on the six sides of a box, each of which a scene may give individually, and their rows.
#pragma once
#include <optional>

#include "engine/core/def/def.h"

namespace truestep::lattice {

inline constexpr const char* kSideNames[3][2] = {{"x_min", "x_max"}, {"y_min", "y_max"}, {"z_min", "z_max"}};

template <class Side>
struct BoxSides {
  std::optional<Side> x_min, x_max, y_min, y_max, z_min, z_max;
  /// In the order x_min, x_max, y_min ...
  const std::optional<Side>& of(size_t axis, size_t end) const {
    const std::optional<Side>* const all[] = {&x_min, &x_max, &y_min, &y_max, &z_min, &z_max};
    return *all[2 * axis + end];
  }
};

/// `side`: the rows of one side.
template <class Side>
const DefTable& box_sides_table(const DefTable& side) {
  using D = BoxSides<Side>;
  static const DefTable kTable = TableOf<D>("the sides of the box")
                                     .object("x_min", &D::x_min, side, "side at the smallest x")
                                     .object("x_max", &D::x_max, side, "side at the largest x")
                                     .object("y_min", &D::y_min, side, "side at the smallest y")
                                     .object("y_max", &D::y_max, side, "side at the largest y")
                                     .object("z_min", &D::z_min, side, "side at the smallest z")
                                     .object("z_max", &D::z_max, side, "side at the largest z")
                                     .build();
  return kTable;
}

}  // namespace truestep::lattice
