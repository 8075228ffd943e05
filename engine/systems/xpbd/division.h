// Into how many substeps a step is divided where the scene does not say: none longer than 1/600 s, of
// materials that bear load at rest none longer than their sweeps hold, and of the rest more while tension
// asks for it (solver.h).
#pragma once
#include <string>

#include "engine/core/build.h"
#include "engine/systems/xpbd/solver.h"
#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

struct Division {
  int substeps;
  SolverOptions::Division division;
  std::string why;  ///< for the plan
};

/// Error "scene_invalid" where a material needs more than a thousand.
Division divide(const XpbdDef& def, const BuildContext& context, const Body& body);

/// Whether tetrahedra have a material, in place of edges and volumes.
bool is_elastic(const XpbdDef& def);

}  // namespace truestep::xpbd
