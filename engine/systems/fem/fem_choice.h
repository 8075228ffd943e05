// Which elements a body has, and how they resist a change of volume, where its scene does not say; and what
// is too stiff all the same. First-order elements cannot bend: cells of length l in a body of thickness t, m
// of them across, carry a bending moment with a shear of their own, too stiffly by (l / t)^2 / 2 (1 + nu),
// and without the curvature across the bend, by nu^2 / (1 - nu^2) m^2 (Hughes 1987, section 4.4). Elements
// that resist a change of volume at every point cannot shear where hardly any is allowed.
#pragma once
#include <optional>
#include <string>

#include "engine/core/warning.h"
#include "engine/systems/fem/fem_def.h"

namespace truestep::fem {

/// What is chosen, and a sentence for the plan.
struct CellChoice {
  Cell cell;
  std::string why;
};
CellChoice choose_cell(const FemDef& def);
/// Never automatic.
Volume volume_of(const FemDef& def);
std::string volume_reason(const FemDef& def);
/// How much too stiffly a block or quad bends in elements of first order, as a share; 0 for others.
double bending_excess(const FemDef& def);
/// What makes a body of these elements too stiff, with a remedy.
std::vector<Warning> locking_of(const FemDef& def);
/// With the choices made that the def leaves open, so that they stay when its resolution changes.
void settle_choices(FemDef& def);

}  // namespace truestep::fem
