// Bonds, angles, dihedrals, rigid waters, and the pairs that they exclude from the pair sum: atoms one or two
// bonds apart.
#pragma once
#include "engine/systems/molecular/atoms.h"
#include "engine/systems/molecular/neighbour_list.h"

namespace truestep::molecular {

/// Pairs i < j, ascending and without repeats.
std::vector<std::array<uint32_t, 2>> excluded_pairs(const MolecularDef& def, const Atoms& atoms);
/// The same per atom.
Exclusions exclusions(const std::vector<std::array<uint32_t, 2>>& pairs, size_t atoms);
/// Checks that the rows of bonds, angles and dihedrals exist and differ.
void check_topology(const MolecularDef& def, size_t atoms, const DefTable::Report& report);

}  // namespace truestep::molecular
