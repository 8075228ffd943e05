// The cost estimate of the system type "fem".
#include <algorithm>
#include <cmath>

#include "engine/systems/fem/fem.h"

namespace truestep::fem {

Cost fem_cost(const void* def) {
  const auto& d = *static_cast<const FemDef*>(def);
  const FemCounts n = fem_counts(d);
  const Element& kind = element_of(kind_of(cell_of(d)));
  const double nodes = static_cast<double>(kind.size()), points = static_cast<double>(kind.points.size());
  const Integrator* named = find_integrator(d.integrator);
  const bool solves = !named || named->kind == Integrator::Kind::implicit;
  // Gradients and weights at the points, slots of the element's blocks, pairs of the pattern.
  const double system =
      n.elements * (points * (24 * nodes + 8) + 4 * nodes * nodes + 8 * nodes) + 4 * n.blocks + 120 * n.nodes;
  // The fill-in of a factor grows with the logarithm of the nodes in the plane and with their cube root in
  // space, for each body by itself; for a strip, as for a square as wide as it.
  const auto bodies = static_cast<double>(std::max<size_t>(d.copies.size(), 1));
  const auto narrow = d.quad ? static_cast<double>(std::min(d.quad->cells_x, d.quad->cells_y)) : HUGE_VAL;
  const double across = nodes > 4 ? 2 * narrow + 1 : narrow + 1;
  const double fill = kind.dimension == 2
                          ? 0.35 * std::log2(std::clamp(across * across, 2.0, std::max(n.nodes, 2.0)))
                          : 0.12 * std::cbrt(n.nodes / bodies) + 0.5;
  const double matrices = (76 * 3 + 84 * fill) * n.blocks + 700 * n.nodes;
  // Measured with linear_implicit_euler, which solves once a step, at 2 to 10,000 elements of every kind: the
  // matrices of an element and the factors of the whole. Newton's method solves one to three times a step.
  const double element_seconds = points * (1.2e-6 + 2e-8 * nodes * nodes);
  const double factor_seconds = (kind.dimension == 2 ? 3e-8 : 7.5e-8) * fill * fill * n.blocks;
  const bool once = named && named->name == "linear_implicit_euler";
  // Linear bodies keep their matrix with the methods that solve by blocks.
  const bool kept = d.material == Law::linear && (!named || once || named->name == "implicit_euler");
  // In equilibrium under loads that do not change there is nothing to solve: forces are evaluated.
  const bool rests = d.motion == Motion::quasi_static && d.load_time == 0 && d.holds.empty();
  const double solves_a_step = rests ? 0.1 : kept ? 0.6 : once ? 1 : 1.7;
  // Incompatible modes: gradients per element, and a solve for the modes with every force and stiffness.
  const double modes =
      d.incompatible_modes == Incompatible::wilson ? n.elements * points * 24 * kind.dimension : 0;
  const double dear = modes > 0 ? 5 : 1;
  // Per node that may touch colliders: contact data.
  const double touches = d.colliders.empty() || d.contact == Meeting::barrier || !solves ? 0 : 250 * n.nodes;
  if (named && named->name == "vertex_block_descent") {
    const double visits = n.elements * nodes * d.choice().options.descent_iterations;
    // Measured with tet4, tet10, hex8 and hex27; corotated elements need a polar decomposition.
    const double each = d.material == Law::corotated ? 8.8e-7 : 5.5e-7;
    return {.state_bytes = 80 * n.nodes,
            .workspace_bytes = system + 8 * nodes * n.elements + 300 * n.nodes,
            .elements = n.nodes + n.elements,
            .seconds_per_step = visits * points * each};
  }
  return {.state_bytes = (touches > 0 ? 156 : 56) * n.nodes,
          .workspace_bytes = touches + modes + system + (solves ? matrices : 100 * n.nodes),
          .elements = n.nodes + n.elements,
          .seconds_per_step = solves ? solves_a_step * (dear * n.elements * element_seconds + factor_seconds)
                                     : 1.5e-7 * n.elements * points};
}

}  // namespace truestep::fem
