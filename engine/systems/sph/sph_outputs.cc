// What a liquid of particles gives out.
#include <algorithm>
#include <cmath>

#include "engine/core/mass_points.h"
#include "engine/core/outputs/outputs_of.h"
#include "engine/core/state/real_column.h"
#include "engine/systems/sph/sph.h"

namespace truestep::sph {

struct Sph::Whole : MassPoints {
  using MassPoints::MassPoints;
  Vec3 angular_momentum, spread;
  double particles = 0, pressure = 0;            ///< kg, Pa
  double mean_error = 0, max_error = 0;          ///< as the last substep found them
  double mean_compression = 0, compression = 0;  ///< the latter: the largest
};

const OutputTable& Sph::outputs() {
  using W = Whole;
  constexpr auto kReal = [](const Sph& f) {
    return f.setting().def.precision == Precision::f32 ? Scalar::f32 : Scalar::f64;
  };
  constexpr auto kReport = [](const Sph&, const State& s, double) { return s.f64(columns::report); };
  static const OutputTable kTable =
      OutputsOf<Sph>(
          "a particle, body after body; rows of removed particles are closed up, new ones come at the end")
          .part("", [](const Sph& f) { return points_part(f.setting().capacity); })
          .rows(present_rows(columns::position))
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(columns::position), "")
          .field_type(kReal)
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(columns::velocity), "")
          .field_type(kReal)
          .field({"density", "kg/m^3"}, computed_by<Sph>(&Sph::density),
                 "from the kernel; with wcsph from continuity")
          .field(
              {"pressure", "Pa"},
              [](const Sph& f, const State& s, const FieldAt& at) -> const void* {
                f.solver_->read_pressures(s, at.scratch);
                return at.scratch.data();
              },
              "the stress that the liquid transmits through an area there, averaged over directions, "
              "including surface tension; near walls, bodies and the surface the solver's own pressure")
          .field({"speed", "m/s"}, length_of(columns::velocity), "")
          .measured(
              &Sph::whole,
              {{"energy.kinetic", "J", &W::kinetic, "of the particles' velocities"},
               {"energy.gravity", "J", &W::height, "potential, about the origin"},
               {"energy.total", "J", &W::total, "their sum"},
               {"momentum", "kg m/s", &W::momentum},
               {"angular_momentum", "kg m^2/s", &W::angular_momentum, "about the origin"},
               {"centre", "m", &W::centre, "of mass"},
               {"spread", "m", &W::spread,
                "root mean square distance of the particles' mass from its centre along x"},
               {"low", "m", &W::lowest, "smallest coordinate of any particle"},
               {"high", "m", &W::highest, "largest coordinate of any particle"},
               {"mass", "kg", &W::particles, "of all particles"},
               {"pressure.mean", "Pa", &W::pressure,
                "mean over the particles of the solver's own pressure, which is 1 to 3 % above the field "
                "where particles are disordered"},
               {"speed.max", "m/s", &W::speed, "of the fastest particle"},
               {"density.mean_error", "1", &W::mean_error,
                "mean relative excess over the rest density found by the last substep (pbf: left by it; "
                "wcsph: mean deviation)"},
               {"density.max_error", "1", &W::max_error, "the largest"},
               {"compression.mean", "1", &W::mean_compression,
                "mean relative excess over the rest density at the start of the last substep"},
               {"compression.max", "1", &W::compression, "the largest"}})
          .measured(
              [](const Sph& f, const State& s, double) { return std::array{f.solver_->read_divergence(s)}; },
              {{"divergence.max", "1/s", entry<0>,
                "largest divergence of the velocity at a particle, from the kernel"}})
          .when_wanted()
          .measured(kReport, {{"courant", "1", entry<report::courant>,
                               "spacings crossed in a substep by whatever limits it"},
                              {"substeps", "1", entry<report::substeps>, "of the last step"},
                              {"iterations.density", "1", entry<report::density_iterations>,
                               "per substep, of the solve for constant density"},
                              {"iterations.divergence", "1", entry<report::flow_iterations>,
                               "per substep, of the solve for zero divergence"}})
          .measured(kReport, {{"iterations.viscosity", "1", entry<report::viscous_iterations>,
                               "per substep, of the solve for viscosity, if there is one"}})
          .when([](const Sph& f) { return f.setting().def.solves_viscosity(); })
          .measured(count_rows(columns::position),
                    {{"count", "1", entry<0>, "particles present, if they come or go"}})
          .when([](const Sph& f) { return f.setting().counts != 0; })
          .measured([](const Sph& f, const State& s, double) { return s.span<uint64_t>(f.setting().counts); },
                    {{"emitted", "1", entry<counts::emitted>, "particles emitted by nozzles"},
                     {"killed", "1", entry<counts::killed>, "particles removed by kill regions"},
                     {"refused", "1", entry<counts::refused>,
                      "particles refused because max_particles was reached"}})
          .when([](const Sph& f) { return f.setting().counts != 0; })
          .build();
  return kTable;
}

const Outputs& sph_outputs() {
  static const Outputs kDescribed = Sph::outputs().described();
  return kDescribed;
}

Sph::Whole Sph::whole(const State& s, double) const {
  const RealColumn<const double> x(s, columns::position), v(s, columns::velocity);
  const RealColumn<const double> density(s, columns::density), pressure(s, columns::pressure);
  Whole out(load3(s.f64(columns::gravity).data(), 0));
  Vec3 squares;
  const size_t n = s.rows(columns::position);
  double pressed = 0, compression = 0;
  for (size_t i = 0; i < n; ++i) {
    const Vec3 at = x.vector(i), u = v.vector(i);
    const double m = setting_->mass * setting_->ratio_of(s, i);
    out.add(m, at, u);
    out.angular_momentum += cross(at, u) * m, pressed += pressure.at(i);
    squares += Vec3{at.x * at.x, at.y * at.y, at.z * at.z} * m;
    const double over = std::max(density.at(i) - 1, 0.0);
    compression += over, out.compression = std::max(out.compression, over);
  }
  const auto count = static_cast<double>(n);
  const Vec3 middle = out.centre();
  const auto spread = [&](double square, double at) {
    return std::sqrt(std::max(square / out.mass - at * at, 0.0));
  };
  out.spread = {spread(squares.x, middle.x), spread(squares.y, middle.y), spread(squares.z, middle.z)};
  out.particles = setting_->ratio ? out.mass : setting_->mass * count;
  if (n > 0) out.pressure = pressed / count, out.mean_compression = compression / count;
  const auto r = s.f64(columns::report);
  out.mean_error = r[report::mean_error], out.max_error = r[report::max_error];
  return out;
}

void Sph::density(const State& s, ShownRows rows, double* out) const {
  const RealColumn<const double> over(s, columns::density);
  for (size_t i = 0; i < rows.count; ++i)
    out[i] = setting_->def.density * setting_->ratio_of(s, i) * over.at(i);
}

}  // namespace truestep::sph
