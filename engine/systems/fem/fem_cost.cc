// Cost estimates of elastic bodies, from counts alone.
#include <algorithm>
#include <cmath>

#include "engine/integrators/table/integrators.h"
#include "engine/systems/fem/fem.h"

namespace truestep::fem {

namespace {

/// What a step multiplies, from counts alone.
struct Work {
  explicit Work(const FemDef& d) : n(fem_counts(d)), kind(element_of(kind_of(cell_of(d)))) {
    // The fill-in of a factor grows with the logarithm of the nodes in the plane and with their cube root in
    // space, for each body by itself; for a strip, as for a square as wide as it.
    const auto bodies = static_cast<double>(std::max<size_t>(d.copies.size(), 1));
    const auto narrow = d.quad ? static_cast<double>(std::min(d.quad->cells_x, d.quad->cells_y)) : HUGE_VAL;
    const double across = nodes() > 4 ? 2 * narrow + 1 : narrow + 1;
    fill = kind.dimension == 2 ? 0.35 * std::log2(std::clamp(across * across, 2.0, std::max(n.nodes, 2.0)))
                               : 0.12 * std::cbrt(n.nodes / bodies) + 0.5;
    // Incompatible modes need a solve of their own with every force and stiffness.
    const double dear = d.incompatible_modes == Incompatible::wilson ? 5 : 1;
    // Measured with linear_implicit_euler, which solves once a step, at 2 to 10,000 elements of every kind:
    // the matrices of an element and the factors of the whole.
    assembly = dear * n.elements * points() * (1.2e-6 + 2e-8 * nodes() * nodes());
    factorisation = (kind.dimension == 2 ? 3e-8 : 7.5e-8) * fill * fill * n.blocks;
  }
  double nodes() const { return static_cast<double>(kind.size()); }
  double points() const { return static_cast<double>(kind.points.size()); }
  double factor_bytes() const { return 84 * fill * n.blocks; }

  FemCounts n;
  const Element& kind;
  double fill;
  double assembly, factorisation;  ///< s
};

bool solves(const Integrator* method) {
  return !method || method->kind == Integrator::Kind::implicit;
}

/// How often a step assembles and factorises: Newton's method one to three times.
double solutions(const FemDef& d, const Integrator* method) {
  // In equilibrium under loads that do not change there is nothing to solve: forces are evaluated.
  if (d.motion == Motion::quasi_static && d.load_time == 0 && d.holds.empty()) return 0.1;
  const bool once = method && method->name == "linear_implicit_euler";
  // Linear bodies keep their matrix with the methods that solve by blocks.
  const bool kept = d.material == Law::linear && (!method || once || method->name == "implicit_euler");
  return kept ? 0.6 : once ? 1 : 1.7;
}

}  // namespace

double step_seconds(const FemDef& d, const Integrator* method) {
  const Work w(d);
  if (method && method->name == "vertex_block_descent") {
    // Measured with tet4, tet10, hex8 and hex27; corotated elements need a polar decomposition.
    const double each = d.material == Law::corotated ? 8.8e-7 : 5.5e-7;
    return w.n.elements * w.nodes() * d.choice().options.descent_iterations * w.points() * each;
  }
  if (!solves(method)) return 1.5e-7 * w.n.elements * w.points();
  return solutions(d, method) * (w.assembly + w.factorisation);
}

AnswersImpulses::Seconds answer_seconds(const FemDef& d) {
  const Work w(d);
  // A solve reads the factor twice.
  constexpr double kCall = 4e-7, kPerByte = 1.2e-10;
  return {kCall + w.assembly + w.factorisation, kCall + kPerByte * w.factor_bytes()};
}

Cost fem_cost(const void* def) {
  const auto& d = *static_cast<const FemDef*>(def);
  const Work w(d);
  const FemCounts& n = w.n;
  const double nodes = w.nodes(), points = w.points();
  const Integrator* named = find_integrator(d.integrator);
  // Gradients and weights at the points, slots of the element's blocks, pairs of the pattern.
  const double system =
      n.elements * (points * (24 * nodes + 8) + 4 * nodes * nodes + 8 * nodes) + 4 * n.blocks + 120 * n.nodes;
  const double matrices = 76 * 3 * n.blocks + w.factor_bytes() + 700 * n.nodes;
  // Incompatible modes: gradients per element.
  const double modes =
      d.incompatible_modes == Incompatible::wilson ? n.elements * points * 24 * w.kind.dimension : 0;
  // Per node that may touch colliders: contact data.
  const double touches =
      d.colliders.empty() || d.contact == Meeting::barrier || !solves(named) ? 0 : 250 * n.nodes;
  if (named && named->name == "vertex_block_descent") {
    return {.state_bytes = 80 * n.nodes,
            .workspace_bytes = system + 8 * nodes * n.elements + 300 * n.nodes,
            .elements = n.nodes + n.elements,
            .seconds_per_step = step_seconds(d, named)};
  }
  return {.state_bytes = (touches > 0 ? 156 : 56) * n.nodes,
          .workspace_bytes = touches + modes + system + (solves(named) ? matrices : 100 * n.nodes),
          .elements = n.nodes + n.elements,
          .seconds_per_step = step_seconds(d, named)};
}

}  // namespace truestep::fem
