// The atoms of a scene: where they start, of which kind they are, and the box that follows from them.
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

/// m, of the box that is given or that the lattice has; 0 where there is none.
Vec3 box_edges(const MolecularDef& def);
/// Number of atoms, from counts alone.
size_t atom_count(const MolecularDef& def);
/// Everything about the start that tables cannot say. `report` as in DefTable.
void check_atoms(const MolecularDef& def, const DefTable::Report& report);
/// Of a def without faults. Velocities of `temperature` are normal numbers of `seed` without momentum, scaled
/// to be of that temperature exactly.
Atoms make_atoms(const MolecularDef& def, uint64_t seed);
/// Masses and sides of the def's water.
WaterShape water_shape(const MolecularDef& def);
/// Row of the kind of that name, or kinds.size().
size_t kind_index(const MolecularDef& def, std::string_view name);
/// m: nearer than this no two atoms may be, a hundredth of the largest sigma (or a thousandth of the
/// cut-off).
double shortest_distance(const MolecularDef& def);

}  // namespace truestep::molecular
