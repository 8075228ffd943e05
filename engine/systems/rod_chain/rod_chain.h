// The system type "rod_chain": thin rigid rods joined end to end by ball joints, the first to an anchor, in
// maximal coordinates (centre x and direction u of every rod),
//   m x'' = m g + sum F,   u' = w x u,   I w' = sum arm x F,   w . u = 0,
// where the joints' forces F must keep C_j = (x_j - a u_j) - (x_{j-1} + a u_{j-1}) at 0 (a: half a length).
// The scene chooses one of three treatments common in the field:
//   penalty     springs, F = -k C - c C'; stable for h < 2 / sqrt(k max eig(J M^-1 J^T)); the gap is F / k.
//               Without "substeps" there are as many as keep h below an eighth of that: the energy of
//               leapfrog (positions half a step ahead of velocities) swings by (omega h)^2 / 8
//   projection  free flight, then the nearest places (by mass) with C = 0, velocities from the places
//               (Mueller et al. 2007, but solved to a tolerance); loses energy in proportion to h
//   lagrange    (J M^-1 J^T) F = -(J M^-1 f + J' v), exact; then C = 0 and C' = 0 are restored by projection
//               (Eich 1993), which is of the size of the method's error. Without "substeps" dop853 chooses
//               its own steps: a chain that whips round is faster than any step chosen beforehand. With them,
//               RK4
// The matrix is block tridiagonal: every treatment costs O(rods).
#pragma once
#include <memory>

#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/def/resolution.h"
#include "engine/core/outputs.h"
#include "engine/core/system.h"

namespace truestep::rod_chain {

struct RodChainDef {
  enum class Treatment : uint8_t { lagrange, projection, penalty } constraints = Treatment::lagrange;
  int64_t links = 10;
  double length = 0.2, mass = 0.1, radius = 0.02;
  Vec3 anchor, direction{1, 0, 0};
  double stiffness = 1e5, damping = 0, tolerance = 1e-13, error_tolerance = 1e-8;
  std::optional<int64_t> substeps;  ///< absent: as many as the treatment needs, see the head
};

const DefTable& rod_chain_table();
/// Its outputs.
const Outputs& rod_chain_outputs();
/// Refinement: the number of rods, with the chain's length and mass kept.
const Resolution& rod_chain_resolution();
std::unique_ptr<const System> build_rod_chain(const void* def, const BuildContext& context);
Cost rod_chain_cost(const void* def);

}  // namespace truestep::rod_chain
