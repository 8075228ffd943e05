// The cost estimate of the system type "xpbd".
#include <algorithm>
#include <cmath>

#include "engine/geometry/make/rope.h"
#include "engine/systems/xpbd/solver.h"
#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

namespace {

/// Substeps per 1/60 s: for a rope, as many as the tension asks for when all of it hangs from its first link.
double substeps_of(const XpbdDef& d, double points) {
  if (d.substeps) return *d.substeps;
  if (d.scheme == Scheme::pbd) return 1;
  constexpr double kUsual = 20, kMost = 1000, kGravity = 9.81, kDt = 1.0 / 60;
  if (!d.rope) return kUsual;
  const double link = rope_link(*d.rope), mass = d.density ? *d.density * link : d.mass;
  double weight = points * mass;
  for (const LoadDef& l : d.loads) weight += l.mass;
  const double tightness = 2 * kGravity * weight / (mass * link);
  return std::clamp(kDt * std::sqrt(2 * tightness), kUsual, kMost);
}

/// Triangles with a material of their own.
double membrane_triangles(const XpbdDef& d, const XpbdCounts& n) {
  return !is_membrane(d) ? 0 : d.mesh ? n.links / 3 : 2 * n.points;
}

}  // namespace

double substep_seconds(const XpbdDef& d) {
  const XpbdCounts n = xpbd_counts(d);
  const double iterations = d.iterations                                          ? *d.iterations
                            : d.scheme == Scheme::pbd || is_simultaneous(d.sweep) ? 20
                                                                                  : 1;
  const bool single = d.precision == Precision::f32, elastic = d.block && d.youngs_modulus;
  const double constraints = n.links + n.bends + n.volumes;
  return 3e-9 * n.points + (d.colliders.empty() ? 0 : 2e-8 * n.points) +
         (d.self_collision ? 1e-6 * n.points : 0) + (d.wind ? 6e-8 * n.points : 0) +
         iterations * (d.rod ? 1.3e-7 : 0) * n.links +
         iterations * (d.matching ? 3e-8 * n.points
                       : elastic  ? 2e-8 * n.volumes
                                  : 0) +
         iterations * 1.5e-8 * membrane_triangles(d, n) + iterations * (single ? 4e-9 : 8e-9) * constraints;
}

Cost xpbd_cost(const void* def) {
  const auto& d = *static_cast<const XpbdDef*>(def);
  const XpbdCounts n = xpbd_counts(d);
  const bool single = d.precision == Precision::f32, collides = !d.colliders.empty();
  const double constraints = n.links + n.bends + n.volumes;
  // Per point: its positions and triangles; per constraint: what the body, the schedule and the solver keep
  // of it. A rope solved directly is one lane of a whole batch, and has scratch if it is long.
  const bool chain = d.rope && d.scheme == Scheme::xpbd && d.sweep == Sweep::chains;
  const double lane = !chain ? 0 : single ? 28 * 7 : 48 * 3;
  const double scratch = chain && n.links > kShortChain ? 224 : 0;
  // Per link of a rod: frames, spins, packed strains (8 Wide numbers per strain row) and scratch, in whole
  // lanes: a single rod takes four times its own.
  const double lanes = !d.rod ? 0 : d.hair ? 1 : 4, rod = d.rod ? n.links * (170 + 620 * lanes) : 0;
  // Cloth that tears: rows that may be split off, corners, and two packed strands a link.
  const double splits =
      !d.tear ? 0 : static_cast<double>(d.tear->most_splits.value_or(static_cast<int64_t>(n.points)));
  const bool elastic = d.block && d.youngs_modulus;
  const double soft = (d.matching ? 90 * n.points : 0) + (elastic ? 90 * n.volumes : 0);
  // Per triangle of a membrane: what the body, the schedule and the solver keep of it.
  const double sheet = membrane_triangles(d, n);
  // Self-collision: a sheet folds onto both its sides, blocks meet with part of their surface.
  const double meets = !d.self_collision ? 0 : d.block ? 900 : 2100;
  const double tears = d.tear ? 250 * splits + (single ? 160 : 260) * 2 * n.links : 0;
  return {
      .state_bytes = 56 * n.points + (d.rod ? 56 * n.links : 0) + (d.tear ? 68 * splits + 36 * n.points : 0),
      .workspace_bytes = rod + tears + soft + 200 * sheet + (single ? 130 : 180) * n.points +
                         ((single ? 85 : 105) + lane + scratch) * n.links +
                         (single ? 130 : 175) * (n.bends + n.volumes) +
                         (collides || d.self_collision ? 104 * n.points : 0) + meets * n.points +
                         (d.wind ? 48 * n.points : 0),
      .elements = n.points + constraints,
      .seconds_per_step = substeps_of(d, n.points) * substep_seconds(d)};
}

}  // namespace truestep::xpbd
