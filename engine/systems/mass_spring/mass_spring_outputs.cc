// What a network of springs gives out.
#include <algorithm>
#include <cmath>

#include "engine/core/equations/force_outputs.h"
#include "engine/core/outputs/outputs_of.h"
#include "engine/systems/mass_spring/mass_spring.h"

namespace truestep::mass_spring {

using C = MassSpringColumns;

struct MassSpring::Whole {
  Vec3 momentum{}, angular_momentum{};
  double largest_strain = 0, rms_strain = 0, pins = 0;
  Vec3 reaction{};
};

const OutputTable& MassSpring::outputs() {
  using M = MassSpring;
  static const OutputTable kTable =
      OutputsOf<M>(
          "a point: along a rope from its first end, strand by strand in hair, j nx + i in a cloth grid, in "
          "the given order in a mesh or free network")
          .part("", [](const M& m) { return points_part(m.springs_.masses().size()); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(C::position), "")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(C::velocity), "")
          .field({"force", "N", Scalar::f64, 3}, computed_by<M>(&M::forces),
                 "sum of all forces on the point; 0 where it is pinned")
          .field({"strain", "1"}, computed_by<M>(&M::largest_strains),
                 "largest |length / rest length - 1| of its springs")
          .field({"reaction", "N", Scalar::f64, 3},
                 computed_by<M>([](const M& m, const State& s, ShownRows rows, double* out) {
                   m.reactions(s, 0, {out, 3 * rows.count});
                 }),
                 "force of the pin on the point; 0 where it is free")
          .part("springs",
                [](const M& m) {
                  const size_t n = m.springs_.schedule().a.size();
                  return n > 0 ? std::optional(values_part(n, PartInfo::Elements::lines)) : std::nullopt;
                })
          .field({"springs.strain", "1"}, computed_by<M>(&M::strains),
                 "of part springs, one row per spring: length / rest length - 1")
          .measured(force_energies, kForceEnergyRows)
          .measured(held_steps, kHeldStepsRows)
          .measured(&M::whole,
                    {{"momentum", "kg m/s", &Whole::momentum, "of all free points"},
                     {"angular_momentum", "kg m^2/s", &Whole::angular_momentum, "about the origin"},
                     {"strain.max", "1", &Whole::largest_strain,
                      "largest |length / rest length - 1| of structural springs"},
                     {"strain.rms", "1", &Whole::rms_strain, "root mean square of the same"},
                     {"pins", "1", &Whole::pins, "points that are pinned"},
                     {"reaction", "N", &Whole::reaction, "sum of the forces of the pins on the points"}})
          .build();
  return kTable;
}

const Outputs& mass_spring_outputs() {
  static const Outputs kDescribed = MassSpring::outputs().described();
  return kDescribed;
}

MassSpring::Whole MassSpring::whole(const State& s, double t) const {
  Whole out;
  const auto x = s.f64(C::position), v = s.f64(C::velocity), w = s.f64(C::inverse_mass);
  for (size_t i = 0; i < w.size(); ++i) {
    if (w[i] > 0) {
      const Vec3 p = springs_.masses()[i] * load3(v.data(), i);
      out.momentum += p, out.angular_momentum += cross(load3(x.data(), i), p);
    } else {
      out.pins += 1;
    }
  }
  double squares = 0;
  size_t count = 0;
  const SpringSchedule& schedule = springs_.schedule();
  for (size_t k = 0; k < schedule.a.size(); ++k) {
    if (schedule.family[k] != SpringFamily::structural && schedule.family[k] != SpringFamily::own) continue;
    const double strain = std::abs(springs_.strain(x, k));
    out.largest_strain = std::max(out.largest_strain, strain), squares += strain * strain, ++count;
  }
  if (count > 0) out.rms_strain = std::sqrt(squares / static_cast<double>(count));
  if (out.pins > 0) {
    std::vector<double> each(x.size());
    reactions(s, t, each);
    for (size_t i = 0; i < w.size(); ++i) out.reaction += load3(each.data(), i);
  }
  return out;
}

void MassSpring::forces(const State& s, ShownRows rows, double* out) const {
  Workspace workspace;
  static const ThreadArena kSerial(1);
  Evaluation e{workspace, kSerial};
  springs_.acceleration({0, s.f64(C::position), s.f64(C::velocity), s}, {out, 3 * rows.count}, e);
  for (size_t i = 0; i < 3 * rows.count; ++i) out[i] *= springs_.masses()[i / 3];
}

void MassSpring::reactions(const State& s, double t, std::span<double> out) const {
  Workspace workspace;
  static const ThreadArena kSerial(1);
  Evaluation e{workspace, kSerial};
  springs_.reactions({t, s.f64(C::position), s.f64(C::velocity), s}, out, e);
}

void MassSpring::largest_strains(const State& s, ShownRows rows, double* out) const {
  std::fill_n(out, rows.count, 0.0);
  const SpringSchedule& schedule = springs_.schedule();
  for (size_t k = 0; k < schedule.a.size(); ++k) {
    const double strain = std::abs(springs_.strain(s.f64(C::position), k));
    for (const uint32_t p : {schedule.a[k], schedule.b[k]}) out[p] = std::max(out[p], strain);
  }
}

void MassSpring::strains(const State& s, ShownRows rows, double* out) const {
  for (size_t k = 0; k < rows.count; ++k) out[k] = springs_.strain(s.f64(C::position), k);
}

}  // namespace truestep::mass_spring
