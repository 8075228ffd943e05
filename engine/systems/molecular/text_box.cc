#include "engine/systems/molecular/text_box.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text/short_number.h"
#include "engine/systems/molecular/xyz.h"

namespace truestep::molecular {

Vec3 box_of_text(const MolecularDef& d) {
  if (d.xyz.empty()) return {};
  XyzLattice lattice;
  try {
    lattice = read_xyz_lattice(d.xyz);
  } catch (const XyzFault&) {
    return {};  // said by check_text_box
  }
  if (!lattice) return {};
  const auto& [a, b, c] = *lattice;
  const double off =
      std::max({std::abs(a.y), std::abs(a.z), std::abs(b.x), std::abs(b.z), std::abs(c.x), std::abs(c.y)});
  const bool along = off <= 1e-9 * std::min({a.x, b.y, c.z});
  return along ? Vec3{a.x, b.y, c.z} * d.xyz_unit : Vec3{};
}

bool check_text_box(const MolecularDef& d, const Vec3& edges, const DefTable::Report& report) {
  if (d.xyz.empty()) return true;
  XyzLattice lattice;
  try {
    lattice = read_xyz_lattice(d.xyz);
  } catch (const XyzFault& f) {
    report("/xyz", "line " + std::to_string(f.line) + ": " + f.what());
    return false;
  }
  if (!lattice) return true;
  const Vec3 text = box_of_text(d);
  if (text == Vec3{}) {
    report("/xyz",
           "line 2: Lattice is not a box along x, y and z: give \"sides\": \"open\" for atoms without a box");
    return false;
  }
  // Digits that were dropped when the text was written.
  if (norm(text - edges) <= 1e-4 * norm(text)) return true;
  std::string why = "differs from the Lattice of xyz, ";
  for (const double edge : {text.x, text.y, text.z}) why += short_number(edge) + " m ";
  report(d.box ? "/box" : "/lattice", why + "along x, y, z: leave it out to take that one");
  return false;
}

}  // namespace truestep::molecular
