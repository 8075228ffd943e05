// Checks of copies, shape matching and elastic blocks in a scene.
#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

const DefTable& copy_table() {
  static const DefTable t =
      TableOf<CopyDef>("a body of this shape, turned about the origin and then moved")
          .vector("position", &CopyDef::position, "m", any(), "by which it is moved")
          .vector("axis", &CopyDef::axis, "1", any(), "about which it is turned")
          .number("angle", &CopyDef::angle, "rad", any(), "by which it is turned")
          .vector("velocity", &CopyDef::velocity, "m/s", any(), "initial, beside that of all")
          .check([](const CopyDef& d, const DefTable::Report& report) {
            if (!(norm2(d.axis) > 0)) report("/axis", "a direction must not be zero");
          })
          .build();
  return t;
}

const DefTable& match_table() {
  static const DefTable t =
      TableOf<MatchDef>("what hangs together is drawn towards its shape at rest, turned and moved")
          .number("frequency", &MatchDef::frequency, "Hz", above(0),
                  "with which a point would swing about its goal; absent: goals are reached at once")
          .number("linear", &MatchDef::linear, "1", between(0, 0.99),
                  "share of goals that follow the body's own stretch and shear, its volume kept; 0: goals "
                  "are rigid")
          .build();
  return t;
}

void check_soft(const XpbdDef& d, const DefTable::Report& report) {
  if (!d.copies.empty() && !d.mesh && !d.block) report("/copies", "only mesh and block have copies");
  const bool elastic = d.block && d.youngs_modulus;
  if (d.matching) {
    if (!d.mesh && !d.block) report("/matching", "only mesh and block are matched");
    if (d.tear) report("/tear", "what is matched has no links that could tear");
    if (d.scheme == Scheme::pbd && d.matching->frequency) {
      report("/matching/frequency", "goals of pbd have none: give projection");
    }
    if (elastic) report("/youngs_modulus", "what is matched has no material: give matching/frequency");
    if (d.flexural_rigidity > 0) report("/flexural_rigidity", "what is matched does not bend by itself");
  }
  if (!elastic && !is_membrane(d) && d.poisson_ratio) {
    report("/poisson_ratio", "only a block with youngs_modulus and a membrane have one");
  }
  if ((d.matching || elastic) && d.internal_damping > 0) {
    report("/internal_damping", "it is along links, and here are none: give damping");
  }
  if (!elastic) return;
  if (d.scheme == Scheme::pbd) report("/scheme", "pbd knows no moduli: use xpbd");
  if (d.precision == Precision::f32) report("/precision", "an elastic block needs f64");
}

}  // namespace truestep::xpbd
