// What a system of particles gives out.
#include "engine/core/equations/force_outputs.h"
#include "engine/core/outputs/outputs_of.h"
#include "engine/systems/particles/particles.h"

namespace truestep::particles {

struct Particles::Whole {
  Vec3 momentum{}, angular_momentum{};
  double count, emitted, killed, refused;
};

const OutputTable& Particles::outputs() {
  static const OutputTable kTable =
      OutputsOf<Particles>(
          "a particle; rows of dead particles are closed up, new ones come at the end (id identifies them)")
          .part("", [](const Particles& p) { return points_part(p.particles_.capacity()); })
          .rows(present_rows(columns::position))
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(columns::position), "")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(columns::velocity), "")
          .field({"speed", "m/s"}, length_of(columns::velocity), "magnitude of the velocity")
          .field({"age", "s"}, computed(&Particles::ages), "time since birth")
          .field({"id", "1", Scalar::u64}, column(columns::id), "number that is never reused")
          .measured(force_energies, kForceEnergyRows)
          .measured(held_steps, kHeldStepsRows)
          .measured(&Particles::whole,
                    {{"momentum", "kg m/s", &Whole::momentum, "of everything that moves freely"},
                     {"angular_momentum", "kg m^2/s", &Whole::angular_momentum, "about the origin"},
                     {"count", "1", &Whole::count, "present particles"},
                     {"emitted", "1", &Whole::emitted, "particles born from emitters and commands"},
                     {"killed", "1", &Whole::killed, "particles removed by planes or age"},
                     {"refused", "1", &Whole::refused, "births refused because max_particles was reached"}})
          .build();
  return kTable;
}

const Outputs& particles_outputs() {
  static const Outputs kDescribed = Particles::outputs().described();
  return kDescribed;
}

void Particles::ages(const State& s, ShownRows rows, double* out) {
  const double now = s.f64(columns::time)[0];
  for (size_t i = 0; i < rows.count; ++i) out[i] = now - s.f64(columns::birth)[i];
}

Particles::Whole Particles::whole(const State& s, double) const {
  const auto count = [&s](Counter c) { return static_cast<double>(counter(s, c)); };
  const auto mass = s.f64(columns::mass);
  Whole out{.count = static_cast<double>(mass.size()),
            .emitted = count(Counter::emitted),
            .killed = count(Counter::killed),
            .refused = count(Counter::refused)};
  const double *x = s.f64(columns::position).data(), *v = s.f64(columns::velocity).data();
  for (size_t i = 0; i < mass.size(); ++i) {
    const Vec3 p = load3(v, i) * mass[i];
    out.momentum += p, out.angular_momentum += cross(load3(x, i), p);
  }
  return out;
}

}  // namespace truestep::particles
