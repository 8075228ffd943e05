// The atoms of a scene: their initial positions, their kinds, and the resulting box.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "engine/kernels/molecular/settle.h"
#include "engine/systems/molecular/molecular_def.h"

namespace truestep::molecular {

struct Atoms {
  std::vector<Vec3> positions, velocities;  // m, m/s
  std::vector<uint32_t> kinds;
  std::vector<std::array<uint32_t, 3>> waters;  // rigid: O, H, H
  Cell cell;
  size_t size() const { return positions.size(); }
};

/// m, the given box or that of the lattice; 0 when there is none.
Vec3 box_edges(const MolecularDef& def);
/// Number of atoms, from counts alone.
size_t atom_count(const MolecularDef& def);
/// Every check of the start that tables cannot express. `report` as in DefTable.
void check_atoms(const MolecularDef& def, const DefTable::Report& report);
/// For a def without faults. Velocities for `temperature` are normal draws of `seed` without net momentum,
/// scaled to exactly that temperature.
Atoms make_atoms(const MolecularDef& def, uint64_t seed);
/// Masses and side lengths of the def's water.
WaterShape water_shape(const MolecularDef& def);
/// Row of the kind with that name, or kinds.size().
size_t kind_index(const MolecularDef& def, std::string_view name);
/// m: no two atoms may be closer than this, a hundredth of the largest sigma (or a thousandth of the
/// cut-off).
double shortest_distance(const MolecularDef& def);

}  // namespace truestep::molecular
