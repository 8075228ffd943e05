// Descriptions of the outputs of the system type "fem".
#include "engine/systems/fem/fem.h"

namespace truestep::fem {

const Outputs& fem_outputs() {
  static const Outputs kOutputs{
      .rows =
          "a node: in a block x fastest, then y, then z; in a quad from the first corner to the second; in a "
          "mesh in the given order; nodes between corners come after all corners",
      .fields = {{"position", "m", 3, ""},
                 {"velocity", "m/s", 3, ""},
                 {"displacement", "m", 3, "from the node's rest position"},
                 {"von_mises", "Pa", 1, "mean of the elements at the node"},
                 {"elements.stress", "Pa", 6,
                  "of part elements, one row per element: Cauchy stress, xx yy zz xy yz xz"},
                 {"elements.strain", "1", 6,
                  "Green strain, (F^T F - 1) / 2; with the linear law the symmetric gradient"},
                 {"elements.von_mises", "Pa", 1, "of the stress"},
                 {"elements.energy_density", "J/m^3", 1, "per volume at rest"},
                 {"elements.jacobian", "1", 1, "smallest volume ratio, det F; 0 or less: inverted"}},
      .observables = {
          {"energy.kinetic", "J", "of motion; 0 in quasi-static motion"},
          {"energy.potential", "J", "elastic and external"},
          {"energy.total", "J", "kinetic and potential"},
          {"energy.elastic", "J", "of the elements"},
          {"energy.external", "J", "of gravity, loads and user forces; pressure has none"},
          {"momentum.x", "kg m/s", "of all free nodes"},
          {"momentum.y", "kg m/s", ""},
          {"momentum.z", "kg m/s", ""},
          {"angular_momentum.x", "kg m^2/s", "about the origin, of all free nodes"},
          {"angular_momentum.y", "kg m^2/s", ""},
          {"angular_momentum.z", "kg m^2/s", ""},
          {"displacement.max", "m", "largest of any node"},
          {"jacobian.min", "1", "smallest det F at any quadrature point"},
          {"pins", "1", "nodes that are fixed in all directions"},
          {"reaction.x", "N", "of all supports on the body"},
          {"reaction.y", "N", ""},
          {"reaction.z", "N", ""},
          {"energy.contact", "J", "of the barrier, not part of the total"},
          {"contact.gap", "m", "smallest distance seen by the barrier, at most contact_distance"},
          {"contact.pairs", "1", "of the barrier: pairs of features nearer than contact_distance"},
          {"frequency.<number>", "1/s", "natural frequencies at rest, as many as modes"}}};
  return kOutputs;
}

}  // namespace truestep::fem
