// Temporarily softened springs, with rest lengths shifted by their tensions, and derivatives under tensions
// of their own (core/equations/softening_forces.h).
#include <algorithm>
#include <cmath>

#include "engine/systems/mass_spring/mass_spring_field.h"

namespace truestep::mass_spring {

using Columns = MassSpringColumns;

namespace {

struct SoftSprings {
  bool on = false;
  double share[kSpringFamilies] = {};      // of the stiffness in use
  double stiffness[kSpringFamilies] = {};  // from the state
  std::vector<double> rest, list_rest;
};
constexpr std::string_view kSoft = "mass_spring.soft";

struct HeldTensions {
  bool on = false;
  std::vector<double> tension;  // N
};
constexpr std::string_view kHeld = "mass_spring.held_tensions";

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

// None is stiffer than `share` of the stiffest: bending that is much softer than the rope keeps its
// stiffness.
MassSpringField::Shares MassSpringField::softened(const double* stiffness, double share) const {
  double stiffest = 0;
  for (size_t f = 0; f < kSpringFamilies; ++f)
    stiffest = std::max(stiffest, stiffness[f] * largest_scale_[f]);
  Shares out;
  for (size_t f = 0; f < kSpringFamilies; ++f) {
    const double own = stiffness[f] * largest_scale_[f];
    out[f] = own > share * stiffest ? share * stiffest / own : 1;
  }
  return out;
}

void MassSpringField::soften(State& state, double share, Evaluation& e) const {
  auto& soft = e.workspace.object<SoftSprings>(kSoft);
  const auto stiffness = state.f64(Columns::stiffness);
  soft.on = true;
  soft.rest = schedule_.rest, soft.list_rest = schedule_.list_rest;
  std::copy_n(stiffness.begin(), kSpringFamilies, soft.stiffness);
  const Shares shares = softened(soft.stiffness, share);
  for (size_t f = 0; f < kSpringFamilies; ++f) soft.share[f] = shares[f], stiffness[f] *= shares[f];
}

SofteningForces::Lengths MassSpringField::shift(const Phase& at, State& state, double share,
                                                Evaluation& e) const {
  auto& soft = e.workspace.object<SoftSprings>(kSoft);
  const double* x = at.x.data();
  const Shares shares = softened(soft.stiffness, share);
  Lengths out;
  for (size_t s = 0; s < schedule_.rest.size(); ++s) {
    const auto f = static_cast<size_t>(schedule_.family[s]);
    if (soft.share[f] == 1 && shares[f] == 1) continue;
    const double l = norm(load3(x, schedule_.b[s]) - load3(x, schedule_.a[s]));
    // Stretch by the tension at full stiffness, and the rest length that gives the same tension at the
    // reduced one.
    const double stretched = soft.share[f] * (l - soft.rest[s]);
    const double shifted = schedule_.rest[s] + stretched - stretched / shares[f];
    out.off = std::max(out.off, std::abs(l - schedule_.rest[s] - stretched));
    out.stretched = std::max(out.stretched, std::abs(stretched));
    soft.rest[s] = shifted;
  }
  for (size_t f = 0; f < kSpringFamilies; ++f) {
    soft.share[f] = shares[f];
    state.f64(Columns::stiffness)[f] = shares[f] * soft.stiffness[f];
  }
  for (size_t j = 0; j < soft.list_rest.size(); ++j) soft.list_rest[j] = soft.rest[schedule_.list_spring[j]];
  return out;
}

void MassSpringField::restore(State& state, Evaluation& e) const {
  auto& soft = e.workspace.object<SoftSprings>(kSoft);
  std::copy_n(soft.stiffness, kSpringFamilies, state.f64(Columns::stiffness).begin());
  soft.on = false;
}

double MassSpringField::spring_constant(const State& state, size_t s) const {
  return state.f64(Columns::stiffness)[static_cast<size_t>(schedule_.family[s])] * schedule_.scale[s];
}

const double* MassSpringField::held_tensions(Evaluation& e) const {
  const auto& held = e.workspace.object<HeldTensions>(kHeld);
  return held.on ? held.tension.data() : nullptr;
}

void MassSpringField::hold_tensions(const Phase& at, Evaluation& e) const {
  auto& held = e.workspace.object<HeldTensions>(kHeld);
  const double* rest = rests(e).springs;
  held.on = true;
  held.tension.resize(schedule_.rest.size());
  for (size_t s = 0; s < schedule_.rest.size(); ++s) {
    const double l = norm(load3(at.x.data(), schedule_.b[s]) - load3(at.x.data(), schedule_.a[s]));
    held.tension[s] = spring_constant(at.state, s) * (l - rest[s]);
  }
}

double MassSpringField::predict_tensions(const Phase& at, std::span<const double> u, double step,
                                         double most_turn, Evaluation& e) const {
  auto& held = e.workspace.object<HeldTensions>(kHeld);
  // f(s, length, motion of b relative to a, part of that along the spring)
  const auto each = [&](auto&& f) {
    for (size_t s = 0; s < schedule_.rest.size(); ++s) {
      const uint32_t a = schedule_.a[s], b = schedule_.b[s];
      const Vec3 d = load3(at.x.data(), b) - load3(at.x.data(), a);
      const Vec3 moved = (load3(u.data(), b) - load3(u.data(), a)) * step;
      const double l = norm(d);
      f(s, l, moved, l > 0 ? dot(d, moved) / l : norm(moved));
    }
  };
  double turn = 0;
  each([&](size_t, double l, const Vec3& moved, double longer) {
    if (l > 0) turn = std::max(turn, std::sqrt(std::max(0.0, norm2(moved) - longer * longer)) / l);
  });
  const double part = turn > most_turn ? most_turn / turn : 1;
  each([&](size_t s, double l, const Vec3&, double longer) {
    const double then = spring_constant(at.state, s) * (l + longer - schedule_.rest[s]);
    held.tension[s] += part * (then - held.tension[s]);
  });
  return part;
}

void MassSpringField::release_tensions(Evaluation& e) const {
  e.workspace.object<HeldTensions>(kHeld).on = false;
}

}  // namespace truestep::mass_spring
