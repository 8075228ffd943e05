// The periodic box that a text in the format XYZ brings along, and whether it is that of its scene.
#pragma once
#include "engine/systems/molecular/molecular_def.h"

namespace truestep::molecular {

/// Edges of the text's box along x, y and z (m): zero without one, or with one that lies otherwise.
Vec3 box_of_text(const MolecularDef& def);
/// Reports a text whose box is not `edges`, or cannot be; true if there is nothing to report.
bool check_text_box(const MolecularDef& def, const Vec3& edges, const DefTable::Report& report);

}  // namespace truestep::molecular
