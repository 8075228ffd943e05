// Checks of copies, shape matching and elastic blocks in a scene.
#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

const DefTable& copy_table() {
  static const DefTable t =
      TableOf<CopyDef>("a copy of this shape, rotated about the origin, then translated")
          .vector("position", &CopyDef::position, "m", any(), "of the translation")
          .vector("axis", &CopyDef::axis, "1", any(), "of the rotation")
          .number("angle", &CopyDef::angle, "rad", any(), "of the rotation")
          .vector("velocity", &CopyDef::velocity, "m/s", any(), "initial, added to that of the system")
          .check([](const CopyDef& d, const DefTable::Report& report) {
            if (!(norm2(d.axis) > 0)) report("/axis", "a direction must not be zero");
          })
          .build();
  return t;
}

const DefTable& match_table() {
  static const DefTable t =
      TableOf<MatchDef>("pulls each connected body towards its rest shape, rotated and translated to fit")
          .number("frequency", &MatchDef::frequency, "Hz", above(0),
                  "at which a point would oscillate about its goal; absent: goals are reached at once")
          .number("linear", &MatchDef::linear, "1", between(0, 0.99),
                  "how far goals follow the body's own stretch and shear at constant volume; 0: rigid goals")
          .build();
  return t;
}

void check_soft(const XpbdDef& d, const DefTable::Report& report) {
  if (!d.copies.empty() && !d.mesh && !d.block) report("/copies", "only mesh and block have copies");
  const bool elastic = d.block && d.youngs_modulus;
  if (d.matching) {
    if (!d.mesh && !d.block) report("/matching", "only mesh and block can use matching");
    if (d.tear) report("/tear", "a body with matching has no links that could tear");
    if (d.scheme == Scheme::pbd && d.matching->frequency) {
      report("/matching/frequency", "goals have no frequency with scheme pbd: give projection");
    }
    if (elastic) report("/youngs_modulus", "a body with matching has no material: give matching/frequency");
    if (d.flexural_rigidity > 0) report("/flexural_rigidity", "a body with matching has no bending rigidity");
  }
  if (!elastic && !is_membrane(d) && d.poisson_ratio) {
    report("/poisson_ratio", "only for a membrane or a block with youngs_modulus");
  }
  if ((d.matching || elastic) && d.internal_damping > 0) {
    report("/internal_damping", "it acts along links, and there are none: give damping");
  }
  if (!elastic) return;
  if (d.scheme == Scheme::pbd) report("/scheme", "scheme pbd has no elastic moduli: use xpbd");
  if (d.precision == Precision::f32) report("/precision", "an elastic block needs f64");
}

}  // namespace truestep::xpbd
