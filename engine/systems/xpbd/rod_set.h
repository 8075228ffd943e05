// Cosserat rods of a body: frames and strains at rest beside its points. Rod r has links + 1 points and
// joints and links + 2 frames: of the wall that holds its first point, of its links, of the wall that holds
// its last point (kernels/xpbd/rod.h). A wall counts where the end is clamped and as long as its point is
// held.
#pragma once
#include <vector>

#include "engine/core/state.h"
#include "engine/kernels/xpbd/rod_strain.h"
#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

/// A section: areas m^2, moments m^4 about d1, d2 and of torsion.
struct Section {
  double area = 0, shear_area = 0, bend1 = 0, bend2 = 0, torsion = 0;
};
Section section_of(const RodDef& rod, double thickness);

struct RodSet {
  size_t rods = 0, links = 0;
  Section section;
  double youngs_modulus = 0, shear_modulus = 0;  ///< Pa
  bool clamped_first = false, clamped_last = false;
  double damping_time = 0;     ///< s
  double twist_rate = 0;       ///< rad/s
  std::vector<Quat> frames;    ///< rods x (links + 2), at the start
  std::vector<Vec3> rest;      ///< rods x (links + 1), 1/m: what bending and twist are without load
  std::vector<double> length;  ///< rods x links, m, at rest
  std::vector<Vec3> inertia;   ///< rods x links, kg m^2, about a section's axes
  State::Column orientation = 0, spin = 0;  ///< of the state: frames; rad/s in their own axes

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
  /// m: half of what lies on both sides.
  double joint_length(size_t rod, size_t joint) const {
    const double* l = length.data() + rod * links;
    return 0.5 * ((joint > 0 ? l[joint - 1] : 0) + (joint < links ? l[joint] : 0));
  }
  /// Whether joint 0 or joint `links` of a rod holds, with 1/kg of the end's point.
  bool holds(size_t joint, double inverse_mass) const {
    if (joint == 0) return clamped_first && !(inverse_mass > 0);
    return joint < links || (clamped_last && !(inverse_mass > 0));
  }
};

/// Rods over points x, rod after rod, of `links` links; `link_mass` in kg.
RodSet build_rods(const XpbdDef& def, const std::vector<Vec3>& x, size_t links, double link_mass);

}  // namespace truestep::xpbd
