// Temporarily softened springs, with rest lengths shifted by their tensions
// (core/equations/softening_forces.h).
#include <algorithm>
#include <cmath>

#include "engine/systems/mass_spring/mass_spring_field.h"

namespace truestep::mass_spring {

using Columns = MassSpringColumns;

namespace {

struct SoftSprings {
  bool on = false;
  double share = 1;
  double stiffness[kSpringFamilies] = {};  // from the state
  std::vector<double> rest, list_rest;
};
constexpr std::string_view kSoft = "mass_spring.soft";

}  // namespace

double MassSpringField::fastest_squared(const State& state) const {
  double k = 0, w = 0;
  for (size_t f = 0; f < kSpringFamilies; ++f) {
    k = std::max(k, state.f64(Columns::stiffness)[f] * largest_scale_[f]);
  }
  for (const double per_mass : state.f64(Columns::inverse_mass)) w = std::max(w, per_mass);
  return 4 * k * w;
}

MassSpringField::Rests MassSpringField::rests(Evaluation& e) const {
  const auto& soft = e.workspace.object<SoftSprings>(kSoft);
  if (soft.on) return {soft.rest.data(), soft.list_rest.data()};
  return {schedule_.rest.data(), schedule_.list_rest.data()};
}

void MassSpringField::soften(State& state, double share, Evaluation& e) const {
  auto& soft = e.workspace.object<SoftSprings>(kSoft);
  const auto stiffness = state.f64(Columns::stiffness);
  soft.on = true, soft.share = share;
  soft.rest = schedule_.rest, soft.list_rest = schedule_.list_rest;
  for (size_t f = 0; f < kSpringFamilies; ++f) {
    soft.stiffness[f] = stiffness[f];
    stiffness[f] *= share;
  }
}

SofteningForces::Lengths MassSpringField::shift(const Phase& at, State& state, double share,
                                                Evaluation& e) const {
  auto& soft = e.workspace.object<SoftSprings>(kSoft);
  const double* x = at.x.data();
  Lengths out;
  for (size_t s = 0; s < schedule_.rest.size(); ++s) {
    const double l = norm(load3(x, schedule_.b[s]) - load3(x, schedule_.a[s]));
    // Stretch by the tension at full stiffness, and the rest length that gives the same tension at the
    // reduced one.
    const double stretched = soft.share * (l - soft.rest[s]);
    const double shifted = schedule_.rest[s] + stretched - stretched / share;
    out.off = std::max(out.off, std::abs(l - schedule_.rest[s] - stretched));
    out.stretched = std::max(out.stretched, std::abs(stretched));
    soft.rest[s] = shifted;
  }
  soft.share = share;
  for (size_t f = 0; f < kSpringFamilies; ++f) {
    state.f64(Columns::stiffness)[f] = share * soft.stiffness[f];
  }
  for (size_t j = 0; j < soft.list_rest.size(); ++j) soft.list_rest[j] = soft.rest[schedule_.list_spring[j]];
  return out;
}

void MassSpringField::restore(State& state, Evaluation& e) const {
  auto& soft = e.workspace.object<SoftSprings>(kSoft);
  std::copy_n(soft.stiffness, kSpringFamilies, state.f64(Columns::stiffness).begin());
  soft.on = false;
}

}  // namespace truestep::mass_spring
