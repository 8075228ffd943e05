// Cosserat rods of a body: frames and rest strains in addition to its points. Rod r has links + 1 points and
// joints and links + 2 frames: one for the wall that holds its first point, one per link, one for the wall
// that holds its last point (kernels/xpbd/rod.h). A wall acts if the end is clamped, and for as long as its
// point is held.
#pragma once
#include <vector>

#include "engine/core/state/state.h"
#include "engine/kernels/xpbd/rod_strain.h"
#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

/// A cross-section: areas m^2, second moments m^4 about d1 and d2, torsion constant m^4.
struct Section {
  double area = 0, shear_area = 0, bend1 = 0, bend2 = 0, torsion = 0;
};
Section section_of(const RodDef& rod, double thickness);

struct RodSet {
  size_t rods = 0, links = 0;
  Section section;
  double youngs_modulus = 0, shear_modulus = 0;  ///< Pa
  bool clamped_first = false, clamped_last = false;
  double damping_time = 0;                  ///< s
  double twist_rate = 0;                    ///< rad/s
  std::vector<Quat> frames;                 ///< rods x (links + 2), at the start
  std::vector<Vec3> rest;                   ///< rods x (links + 1), 1/m: bending and twist without load
  std::vector<double> length;               ///< rods x links, m, at rest
  std::vector<Vec3> inertia;                ///< rods x links, kg m^2, about a section's axes
  State::Column orientation = 0, spin = 0;  ///< of the state: frames; rad/s in each frame's own axes

  /// N, along d1, d2 (shear) and d3.
  Vec3 stretching() const {
    const double shear = shear_modulus * section.shear_area;
    return {shear, shear, youngs_modulus * section.area};
  }
  /// N m^2, about d1, d2 and d3 (twist).
  Vec3 bending() const {
    return {youngs_modulus * section.bend1, youngs_modulus * section.bend2, shear_modulus * section.torsion};
  }
  bool empty() const { return rods == 0; }
  size_t first_point(size_t rod) const { return rod * (links + 1); }
  size_t first_frame(size_t rod) const { return rod * (links + 2); }
  size_t first_joint(size_t rod) const { return rod * (links + 1); }
  /// m: half of the links on both sides.
  double joint_length(size_t rod, size_t joint) const {
    const double* l = length.data() + rod * links;
    return 0.5 * ((joint > 0 ? l[joint - 1] : 0) + (joint < links ? l[joint] : 0));
  }
  /// Whether joint 0 or joint `links` of a rod is clamped, given 1/kg of its end point.
  bool holds(size_t joint, double inverse_mass) const {
    if (joint == 0) return clamped_first && !(inverse_mass > 0);
    return joint < links || (clamped_last && !(inverse_mass > 0));
  }
};

/// Rods through points x, rod after rod, of `links` links each; `link_mass` in kg.
RodSet build_rods(const XpbdDef& def, const std::vector<Vec3>& x, size_t links, double link_mass);

}  // namespace truestep::xpbd
