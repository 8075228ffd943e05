// How many substeps a step is divided into if the scene does not say: none longer than 1/600 s; for materials
// that bear load at rest, none longer than their sweeps are stable; otherwise more while tension asks for it
// (solver.h).
#pragma once
#include <string>

#include "engine/core/def/build.h"
#include "engine/systems/xpbd/solver.h"
#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

struct Division {
  int substeps;
  SolverOptions::Division division;
  std::string why;  ///< for the plan
};

/// Error "scene_invalid" if a material needs more than a thousand.
Division divide(const XpbdDef& def, const BuildContext& context, const Body& body);

/// s: the longest stable substep of elastic blocks and sheets; infinite for others.
double longest_substep(const XpbdDef& def, const Body& body);

/// Whether tetrahedra have an elastic material instead of edge and volume constraints.
bool is_elastic(const XpbdDef& def);

}  // namespace truestep::xpbd
