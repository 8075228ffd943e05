#include "engine/systems/xpbd/tearing/division.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"

namespace truestep::xpbd {

namespace {

/// Whether constraints carry load at rest, so that the neglected geometric stiffness is that of the material.
bool stiff_at_rest(const XpbdDef& def) {
  return is_elastic(def) || (is_membrane(def) && def.membrane == Membrane::neo_hookean);
}

constexpr double kLongestSubstep = 1.0 / 600;  // s

// Sweeps neglect the geometric stiffness (the
/// rotation of the gradients), which is as large as the material's, so h^2 V (mu + l) sum w |grad|^2 has to
/// stay below kMostGeometric (kernels/xpbd/neo_hookean.h).
double longest_stable(const XpbdDef& def, const Body& body) {
  const double nu = def.poisson_ratio.value_or(0.3);
  double most = 0;
  constexpr double kMostGeometric = 4;
  // An element's two constraints are never both met, so shear is resisted by their difference, as in an
  // explicit method. Unstable at any Poisson's ratio from -0.3 to 0.48: of 90 blocks one at 1.4 and none
  // below, of 24 sheets one at 1.0 and none below.
  constexpr double kMostOfBlock = 1.2, kMostOfSheet = 0.8;
  if (stiff_at_rest(def) && !is_elastic(def)) {
    const double mu = 0.5 * *def.youngs_modulus / (1 + nu), l = mu * (1 + nu) / (1 - nu),
                 stiffest = std::max(mu + l, mu * kMostGeometric / kMostOfSheet);
    for (const SheetTriangle& t : body.sheet) {
      const auto& b = t.inverse;
      const Vec3 g[2] = {{b[0], b[1], 0}, {b[2], b[3], 0}};
      double sum = norm2(g[0] + g[1]) / body.masses[t.points[0]];
      for (size_t i = 0; i < 2; ++i) sum += norm2(g[i]) / body.masses[t.points[i + 1]];
      most = std::max(most, t.volume * stiffest * sum);
    }
    return most > 0 ? std::sqrt(kMostGeometric / most) : HUGE_VAL;
  }
  if (!is_elastic(def)) return HUGE_VAL;
  const double mu = 0.5 * *def.youngs_modulus / (1 + nu);
  const double stiffest = std::max(mu + mu / (1 - 2 * nu), mu * kMostGeometric / kMostOfBlock);
  for (const Tetrahedron& t : body.tetrahedra) {
    const Vec3 g[3] = {t.inverse.row(0), t.inverse.row(1), t.inverse.row(2)};
    double sum = norm2(g[0] + g[1] + g[2]) / body.masses[t.points[0]];
    for (size_t i = 0; i < 3; ++i) sum += norm2(g[i]) / body.masses[t.points[i + 1]];
    most = std::max(most, t.rest * stiffest * sum);
  }
  return std::sqrt(kMostGeometric / most);
}

}  // namespace

double longest_substep(const XpbdDef& def, const Body& body) {
  return def.scheme == Scheme::pbd ? HUGE_VAL : longest_stable(def, body);
}

bool is_elastic(const XpbdDef& def) {
  return def.block && def.youngs_modulus;
}

Division divide(const XpbdDef& def, const BuildContext& context, const Body& body) {
  using enum SolverOptions::Division;
  if (def.substeps) return {*def.substeps, fixed, "named by the scene"};
  if (def.scheme == Scheme::pbd) return {1, fixed, "textbook PBD does not divide the step"};
  constexpr double kMost = 1000;
  const double longest = std::min(kLongestSubstep, longest_stable(def, body));
  const double n = std::max(1.0, std::ceil(context.dt / longest * (1 - 1e-9)));
  if (n > kMost && stiff_at_rest(def)) {
    const std::string message = "this stiffness needs " + std::to_string(static_cast<int64_t>(n)) +
                                " substeps per step, and at most 1000 are allowed: use a softer material, "
                                "larger cells, a shorter time.dt or fem";
    throw Error("scene_invalid", "/youngs_modulus: " + message,
                {"/youngs_modulus", "too_stiff", message, std::to_string(*def.youngs_modulus), "", "", ""});
  }
  if (stiff_at_rest(def)) return {static_cast<int>(n), fixed, "as short as the stiffness requires"};
  return {static_cast<int>(std::min(n, kMost)), by_tension,
          "and more while tension would turn links too far in one substep"};
}

}  // namespace truestep::xpbd
