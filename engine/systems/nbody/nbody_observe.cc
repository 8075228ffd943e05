// Observables of an N-body state, as astronomers plot them.
#include <algorithm>
#include <cmath>

#include "engine/base/text/short_number.h"
#include "engine/systems/nbody/collisions/impacts.h"
#include "engine/systems/nbody/nbody.h"

namespace truestep::nbody {

namespace {

/// m: radius around the centre of mass that contains half of the mass.
double half_mass_radius(const State& s, const Vec3& center, double all) {
  const auto mass = s.f64(Columns::mass);
  const double* x = s.f64(Columns::position).data();
  std::vector<std::pair<double, double>> shells;
  for (size_t i = 0; i < mass.size(); ++i) shells.push_back({norm(load3(x, i) - center), mass[i]});
  std::sort(shells.begin(), shells.end());
  double within = 0;
  for (const auto& [r, m] : shells) {
    within += m;
    if (within >= 0.5 * all) return r;
  }
  return 0;
}

}  // namespace

void Nbody::observe(const State& s, double t, Observables& out) const {
  ForceSystem::observe(s, t, out);
  const auto mass = s.f64(Columns::mass);
  const double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  Vec3 p, l, center;
  double all = 0;
  for (size_t i = 0; i < mass.size(); ++i) {
    const Vec3 xi = load3(x, i), pi = load3(v, i) * mass[i];
    p += pi, l += cross(xi, pi), center += xi * mass[i], all += mass[i];
  }
  if (all > 0) center = center / all;
  const auto add3 = [&](const char* name, const Vec3& a, const char* unit) {
    out.add(std::string(name) + ".x", a.x, unit);
    out.add(std::string(name) + ".y", a.y, unit);
    out.add(std::string(name) + ".z", a.z, unit);
  };
  add3("momentum", p, "kg m/s"), add3("angular_momentum", l, "kg m^2/s"), add3("center", center, "m");
  const double kinetic = out.find("energy.kinetic").value_or(0),
               potential = out.find("energy.potential").value_or(0);
  out.add("virial_ratio", potential < 0 ? -2 * kinetic / potential : 0.0, "1");
  out.add("half_mass_radius", half_mass_radius(s, center, all), "m");
  out.add("count", static_cast<double>(mass.size()), "1");
  out.add("collisions", static_cast<double>(counter(s, Counter::collisions)), "1");
  if (!bodies_.def().collisions) return;
  out.add("collisions.left_over", impact(s, Impact::left_over), "1");
  out.add("collisions.step_ratio", impact(s, Impact::largest_ratio), "1");
}

void Nbody::warn(const State& s, double h, std::vector<Warning>& out) const {
  if (!bodies_.def().collisions) return;
  if (const double left = impact(s, Impact::left_over); left > 0) {
    out.push_back({"collisions.left_over", left, 0,
                   "more bodies touched within a step than it has room for; they only lost their speed of "
                   "approach, or passed: a shorter step would do",
                   h / 8});
  }
  // A leapfrog step of the length 0.2 in these units is off by 0.2^2 / 24 of the pair's energy.
  constexpr double kResolved = 0.2;
  if (const double ratio = impact(s, Impact::largest_ratio); ratio > kResolved) {
    const double dt = h * kResolved / ratio;
    out.push_back({"collisions.step_ratio", ratio, kResolved,
                   "bodies that touch fall faster than steps of this length resolve: dt " +
                       short_number(dt, 2) + " s, or ias15, would do",
                   dt});
  }
}

}  // namespace truestep::nbody
