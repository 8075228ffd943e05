// What an N-body system gives out, as astronomers plot it.
#include <algorithm>
#include <cmath>

#include "engine/core/equations/force_outputs.h"
#include "engine/core/outputs/outputs_of.h"
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

struct Nbody::Whole : ForceEnergies {
  Vec3 momentum{}, angular_momentum{}, center{};
  double virial_ratio = 0, half_mass_radius = 0, count = 0, collisions = 0;
};
struct Nbody::Touches {
  double left_over, step_ratio;
};

const OutputTable& Nbody::outputs() {
  using C = Columns;
  static const OutputTable kTable =
      OutputsOf<Nbody>(
          "a body, first those of positions, then those of groups; rows of bodies that merged into others "
          "are closed up (id identifies them)")
          .part("", [](const Nbody& n) { return points_part(n.parts()[0].max_rows); })
          .rows(present_rows(C::position))
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(C::position), "")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(C::velocity), "")
          .field({"speed", "m/s"}, length_of(C::velocity), "magnitude of the velocity")
          .field({"mass", "kg"}, column(C::mass), "")
          .field({"id", "1", Scalar::u64}, column(C::id), "row at t = 0")
          .measured(
              &Nbody::whole,
              {{"energy.kinetic", "J", &Whole::kinetic, "of motion"},
               {"energy.potential", "J", &Whole::potential, "of the bodies' attraction, negative"},
               {"energy.total", "J", &Whole::total, "their sum"},
               {"momentum", "kg m/s", &Whole::momentum},
               {"angular_momentum", "kg m^2/s", &Whole::angular_momentum, "about the origin"},
               {"center", "m", &Whole::center, "centre of mass"},
               {"virial_ratio", "1", &Whole::virial_ratio, "2 K / |W|: 1 in balance, 0 without attraction"},
               {"half_mass_radius", "m", &Whole::half_mass_radius, "around the centre of mass"},
               {"count", "1", &Whole::count, "present bodies"},
               {"collisions", "1", &Whole::collisions, "collisions so far"}})
          .measured([](const Nbody&, const State& s, double) { return touches(s); },
                    {{"collisions.left_over", "1", &Touches::left_over,
                      "with collisions: touches for which a step had no room, so far"},
                     {"collisions.step_ratio", "1", &Touches::step_ratio,
                      "with collisions and a fixed-step method: the step over the shortest time sqrt(R^3 / "
                      "(G m)) of bodies that touched"}})
          .when([](const Nbody& n) { return n.bodies_.def().collisions.has_value(); })
          .build();
  return kTable;
}

const Outputs& nbody_outputs() {
  static const Outputs kDescribed = Nbody::outputs().described();
  return kDescribed;
}

Nbody::Whole Nbody::whole(const State& s, double t) const {
  Whole out{force_energies(*this, s, t)};
  const auto mass = s.f64(Columns::mass);
  const double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  double all = 0;
  for (size_t i = 0; i < mass.size(); ++i) {
    const Vec3 xi = load3(x, i), pi = load3(v, i) * mass[i];
    out.momentum += pi, out.angular_momentum += cross(xi, pi), out.center += xi * mass[i], all += mass[i];
  }
  if (all > 0) out.center = out.center / all;
  const double potential = out.potential.value_or(0);
  out.virial_ratio = potential < 0 ? -2 * out.kinetic / potential : 0.0;
  out.half_mass_radius = truestep::nbody::half_mass_radius(s, out.center, all);
  out.count = static_cast<double>(mass.size());
  out.collisions = static_cast<double>(counter(s, Counter::collisions));
  return out;
}

Nbody::Touches Nbody::touches(const State& s) {
  return {impact(s, Impact::left_over), impact(s, Impact::largest_ratio)};
}

}  // namespace truestep::nbody
