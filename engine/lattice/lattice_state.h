// States on a lattice: columns with their initial values, integrals over the box, and commands that add at a
// point.
#pragma once
#include <span>
#include <vector>

#include "engine/core/commands/command.h"
#include "engine/core/part.h"
#include "engine/core/state/state.h"
#include "engine/lattice/lattice.h"

namespace truestep::lattice {

State::Column add_column(State& state, ColumnInfo info, const std::vector<double>& values);

/// The nodes as a system's main part.
PartInfo grid_part(const Lattice& lattice, std::vector<FieldInfo> fields);

/// Sum of u times the nodes' volumes, in the order of the rows.
double integral(const Lattice& lattice, std::span<const double> u);

/// Adds `amount` (the integral of what is added) at the node with the command's index, or spread over the
/// nodes around its position `at` so that its centre lies there. Error "bad_command" for nodes that do not
/// exist or have a given value, or positions outside the box.
void add_at(const Lattice& lattice, const Command& command, double amount, std::span<double> u);

}  // namespace truestep::lattice
