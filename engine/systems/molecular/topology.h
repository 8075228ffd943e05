// What belongs together: bonds, angles, dihedrals, rigid waters, and the pairs that they leave out of the sum
// over pairs, namely those of atoms one or two bonds apart.
#pragma once
#include "engine/systems/molecular/atoms.h"
#include "engine/systems/molecular/neighbour_list.h"

namespace truestep::molecular {

/// Pairs i < j, ascending and without repeats.
std::vector<std::array<uint32_t, 2>> excluded_pairs(const MolecularDef& def, const Atoms& atoms);
/// The same for every atom.
Exclusions exclusions(const std::vector<std::array<uint32_t, 2>>& pairs, size_t atoms);
/// Rows of bonds, angles and dihedrals that are there and differ.
void check_topology(const MolecularDef& def, size_t atoms, const DefTable::Report& report);

}  // namespace truestep::molecular
