// Checks of Cosserat rods in a scene; see kernels/xpbd/rod_strain.h.
#include <algorithm>

#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

const DefTable& rod_table() {
  static const DefTable t = [] {
    using D = RodDef;
    return TableOf<D>("rods of an elastic material that stretch, shear, bend and twist")
        .number("youngs_modulus", &D::youngs_modulus, "Pa", above(0), "of the material")
        .required()
        .number("poisson_ratio", &D::poisson_ratio, "1", between(-0.99, 0.5),
                "of the material: its shear modulus is E / 2 (1 + nu)")
        .number("shear_modulus", &D::shear_modulus, "Pa", above(0), "of the material, given directly")
        .number("width", &D::width, "m", above(0),
                "of a rectangular section, with height; absent: round, with the thickness as its diameter")
        .number("height", &D::height, "m", above(0), "of a rectangular section, along up")
        .number("torsion_constant", &D::torsion_constant, "m^4", above(0),
                "J of the section: twisting moment / (shear modulus * twist per metre); default: of the "
                "round section, or of the rectangle after Roark")
        .choice("natural", &D::natural, {"as_shaped", "straight"},
                "shape of the unloaded rods: curved as at the start, or straight")
        .number(
            "twist", &D::twist, "rad", any(),
            "by which the last section is turned against the first at the start, beyond the unloaded twist")
        .number("twist_rate", &D::twist_rate, "rad/s", any(),
                "at which a clamped last section turns about the rod")
        .number("damping_time", &D::damping_time, "s", at_least(0),
                "internal: viscous over elastic stiffness, for forces and moments")
        .vector("up", &D::up, "1", any(), "the height of the first section is as close to it as possible")
        .texts("clamped", &D::clamped, {},
               "ends of fixed position and direction: first, last, ends; roots of hair always are")
        .check([](const D& d, const DefTable::Report& report) {
          if (d.width.has_value() != d.height.has_value()) {
            report(d.width ? "/height" : "/width", "a rectangular section needs width and height");
          }
          if (!(norm2(d.up) > 0)) report("/up", "a direction must not be zero");
        })
        .build();
  }();
  return t;
}

std::vector<std::string> clamp_names(const XpbdDef& d) {
  if (d.hair) return {"roots"};
  return {"first", "last", "ends"};
}

void check_rod(const XpbdDef& d, const DefTable::Report& report) {
  if (!d.rod) return;
  if (!d.rope && !d.helix && !d.hair) return report("/rod", "only rope, helix and hair can be rods");
  const auto refuse = [&](bool given, const char* what, const char* instead) {
    if (given) report(std::string("/") + what, std::string("does not apply to rods: ") + instead);
  };
  refuse(d.youngs_modulus.has_value(), "youngs_modulus", "give it in rod");
  refuse(d.bending_rigidity > 0, "bending_rigidity", "it follows from rod/youngs_modulus and the section");
  refuse(d.internal_damping > 0, "internal_damping", "give rod/damping_time");
  if (d.scheme == Scheme::pbd)
    report("/scheme", "rods need elastic moduli, which pbd does not have: use xpbd");
  if (d.sweep == Sweep::links) report("/sweep", "a rod is solved as a whole: use chains");
  if (d.precision == Precision::f32) report("/precision", "rods need f64");
  if (!d.rod->width && !(d.thickness > 0)) report("/thickness", "a round section needs a thickness above 0");
  const std::vector<std::string> names = clamp_names(d);
  bool last = false;
  for (size_t i = 0; i < d.rod->clamped.size(); ++i) {
    const std::string& name = d.rod->clamped[i];
    last |= name == "last" || name == "ends";
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    std::string allowed;
    for (const std::string& n : names) allowed += (allowed.empty() ? "" : ", ") + n;
    report("/rod/clamped/" + std::to_string(i), "this shape can be clamped at: " + allowed);
  }
  if (d.rod->twist_rate != 0 && !last) {
    report("/rod/twist_rate", "only a clamped last section can turn: add \"last\" to clamped");
  }
}

}  // namespace truestep::xpbd
