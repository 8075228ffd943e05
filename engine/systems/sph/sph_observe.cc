// Observables of a fluid's state, its warnings, and the descriptions of its outputs.
#include <algorithm>
#include <cmath>

#include "engine/base/text/short_number.h"
#include "engine/core/mass_points.h"
#include "engine/core/state/real_column.h"
#include "engine/systems/sph/sph.h"

namespace truestep::sph {

void Sph::observe(const State& s, double, Observables& out) const {
  const RealColumn<const double> x(s, columns::position), v(s, columns::velocity);
  MassPoints all(load3(s.f64(columns::gravity).data(), 0));
  Vec3 l, squares;
  const size_t n = s.rows(columns::position);
  double pressed = 0, compression = 0, densest = 0;
  const RealColumn<const double> density(s, columns::density), pressure(s, columns::pressure);
  for (size_t i = 0; i < n; ++i) {
    const Vec3 at = x.vector(i), u = v.vector(i);
    const double m = setting_->mass * setting_->ratio_of(s, i);
    all.add(m, at, u);
    l += cross(at, u) * m, pressed += pressure.at(i);
    squares += Vec3{at.x * at.x, at.y * at.y, at.z * at.z} * m;
    const double over = std::max(density.at(i) - 1, 0.0);
    compression += over, densest = std::max(densest, over);
  }
  all.observe_energy(out);
  add_vector(out, "momentum", all.momentum, "kg m/s");
  add_vector(out, "angular_momentum", l, "kg m^2/s");
  all.observe_centre(out);
  const Vec3 at = all.centre();
  const auto spread = [&](double square, double middle) {
    return std::sqrt(std::max(square / all.mass - middle * middle, 0.0));
  };
  add_vector(out, "spread", {spread(squares.x, at.x), spread(squares.y, at.y), spread(squares.z, at.z)}, "m");
  all.observe_extent(out);
  out.add("mass", setting_->ratio ? all.mass : setting_->mass * static_cast<double>(n), "kg");
  out.add("pressure.mean", n > 0 ? pressed / static_cast<double>(n) : 0, "Pa");
  out.add("speed.max", all.speed(), "m/s");
  const auto r = s.f64(columns::report);
  out.add("density.mean_error", r[report::mean_error], "1");
  out.add("density.max_error", r[report::max_error], "1");
  out.add("compression.mean", n > 0 ? compression / static_cast<double>(n) : 0, "1");
  out.add("compression.max", densest, "1");
  if (out.wants("divergence.max")) out.add("divergence.max", solver_->read_divergence(s), "1/s");
  out.add("courant", r[report::courant], "1");
  out.add("substeps", r[report::substeps], "1");
  out.add("iterations.density", r[report::density_iterations], "1");
  out.add("iterations.divergence", r[report::flow_iterations], "1");
  if (r.size() > report::viscous_iterations) {
    out.add("iterations.viscosity", r[report::viscous_iterations], "1");
  }
  if (!setting_->counts) return;
  const auto c = s.span<uint64_t>(setting_->counts);
  out.add("count", static_cast<double>(n), "1");
  out.add("emitted", static_cast<double>(c[counts::emitted]), "1");
  out.add("killed", static_cast<double>(c[counts::killed]), "1");
  out.add("refused", static_cast<double>(c[counts::refused]), "1");
}

// A mean density error above 1 %: more than weakly compressible flow should have (Monaghan 1994), and above
// the usual tolerances of solves. The number of spacings crossed needs no check: long steps are divided.
/// Whether anything but the liquid's own weight can do work on it.
bool Sph::driven(const Vec3& gravity) const {
  const SphDef& d = setting_->def;
  const auto& solids = setting_->colliders.colliders();
  const auto& meshes = setting_->meshes;
  const bool wall =
      std::any_of(solids.begin(), solids.end(), [](const Collider& c) { return !c.motion.at_rest(); }) ||
      std::any_of(meshes.begin(), meshes.end(),
                  [](const MeshWall& m) { return !m.collider.motion.at_rest(); });
  const bool around =
      (d.wraps(0) && gravity.x != 0) || (d.wraps(1) && gravity.y != 0) || (d.wraps(2) && gravity.z != 0);
  return wall || around || !d.emitters.empty() || d.vorticity > 0 ||
         (d.walls == Walls::no_slip && norm2(d.lid_velocity) > 0);
}

std::optional<Energy> Sph::energy(const State& s, double, Workspace&, const ThreadArena&) const {
  // The first substep moves an uneven start by less than this share of a spacing.
  constexpr double kShift = 0.1;
  const SphDef& d = setting_->def;
  const Vec3 g = load3(s.f64(columns::gravity).data(), 0);
  const Vec3 lowest{g.x < 0 ? d.low.x : d.high.x, g.y < 0 ? d.low.y : d.high.y, g.z < 0 ? d.low.z : d.high.z};
  const RealColumn<const double> x(s, columns::position), v(s, columns::velocity);
  const size_t n = s.rows(columns::position);
  Energy e;
  double ratios = 0;
  for (size_t i = 0; i < n; ++i) {
    const double ratio = setting_->ratio_of(s, i);
    ratios += ratio;
    e.kinetic += 0.5 * ratio * norm2(v.vector(i)), e.potential -= ratio * dot(g, x.vector(i) - lowest);
  }
  const double mass = setting_->mass, shift = kShift * d.spacing / dt_;
  e.kinetic *= mass, e.potential *= mass;
  // Surface energy is not counted: it is at most that of single particles.
  const double surface = d.dimension == 2 ? 4 * d.spacing : 6 * d.spacing * d.spacing;
  e.slack = mass * ratios * (0.5 * shift * shift + norm(g) * d.spacing) +
            d.surface_tension * surface * static_cast<double>(n);
  e.exchange = driven(g) ? Energy::Exchange::open : Energy::Exchange::closed;
  return e;
}

void Sph::warn(const State& s, double h, std::vector<Warning>& out) const {
  constexpr double kMostOff = 0.01, kSpare = 1.1;
  const SphDef& d = setting_->def;
  const auto r = s.f64(columns::report);
  const double value = r[report::mean_error], limit = std::max(kMostOff, d.density_error);
  if (!(value > limit)) return;
  Warning w{.quantity = "density.mean_error", .value = value, .limit = limit};
  w.detail = "density is " + short_number(100 * value, 2) + " % off on average: ";
  if (d.solver == Method::wcsph) {
    // At the same pressures, a speed of sound sqrt(k) times as large gives a k-th of the error; but a liquid
    // that has collapsed shows only a part of its pressure.
    const double more = kSpare * setting_->sound * std::sqrt(value / limit);
    const double enough = setting_->sound_for(load3(s.f64(columns::gravity).data(), 0));
    w.detail += "a sound_speed of " + short_number(std::max(more, enough), 2) + " m/s would do";
  } else if (setting_->closed) {
    // Nothing solves for the density there: particles that are shifted keep it.
    w.detail += "a smaller spacing or more shifting would do";
  } else {
    // Compression per substep grows with the square of its length.
    w.suggested_dt = h / std::max(1.0, r[report::substeps]) * std::sqrt(limit / value) / kSpare;
    w.detail += "dt " + short_number(w.suggested_dt, 2) + " s, or more " +
                (d.solver == Method::pbf ? "pbf_iterations" : "max_iterations") + " would do";
  }
  out.push_back(std::move(w));
}

const Outputs& sph_outputs() {
  static const Outputs kOutputs{
      .rows =
          "a particle, body after body; rows of removed particles are closed up, new ones come at the end",
      .fields = {{"position", "m", 3, ""},
                 {"velocity", "m/s", 3, ""},
                 {"density", "kg/m^3", 1, "from the kernel; with wcsph from continuity"},
                 {"pressure", "Pa", 1,
                  "the stress that the liquid transmits through an area there, averaged over directions, "
                  "including surface tension; near walls, bodies and the surface the solver's own "
                  "pressure"},
                 {"speed", "m/s", 1, ""}},
      .observables = {
          {"energy.kinetic", "J", "of the particles' velocities"},
          {"energy.gravity", "J", "potential, about the origin"},
          {"energy.total", "J", "their sum"},
          {"momentum.x", "kg m/s", ""},
          {"momentum.y", "kg m/s", ""},
          {"momentum.z", "kg m/s", ""},
          {"angular_momentum.x", "kg m^2/s", "about the origin"},
          {"angular_momentum.y", "kg m^2/s", ""},
          {"angular_momentum.z", "kg m^2/s", ""},
          {"centre.x", "m", "of mass"},
          {"centre.y", "m", ""},
          {"centre.z", "m", ""},
          {"spread.x", "m", "root mean square distance of the particles' mass from its centre along x"},
          {"spread.y", "m", ""},
          {"spread.z", "m", ""},
          {"low.x", "m", "smallest coordinate of any particle"},
          {"low.y", "m", ""},
          {"low.z", "m", ""},
          {"high.x", "m", "largest coordinate of any particle"},
          {"high.y", "m", ""},
          {"high.z", "m", ""},
          {"mass", "kg", "of all particles"},
          {"pressure.mean", "Pa",
           "mean over the particles of the solver's own pressure, which is 1 to 3 % above the field "
           "where particles are disordered"},
          {"speed.max", "m/s", "of the fastest particle"},
          {"density.mean_error", "1",
           "mean relative excess over the rest density found by the last substep (pbf: left by it; "
           "wcsph: mean deviation)"},
          {"density.max_error", "1", "the largest"},
          {"compression.mean", "1",
           "mean relative excess over the rest density at the start of the last substep"},
          {"compression.max", "1", "the largest"},
          {"divergence.max", "1/s", "largest divergence of the velocity at a particle, from the kernel"},
          {"courant", "1", "spacings crossed in a substep by whatever limits it"},
          {"substeps", "1", "of the last step"},
          {"iterations.density", "1", "per substep, of the solve for constant density"},
          {"iterations.divergence", "1", "per substep, of the solve for zero divergence"},
          {"iterations.viscosity", "1", "per substep, of the solve for viscosity, if there is one"},
          {"count", "1", "particles present, if they come or go"},
          {"emitted", "1", "particles emitted by nozzles"},
          {"killed", "1", "particles removed by kill regions"},
          {"refused", "1", "particles refused because max_particles was reached"}}};
  return kOutputs;
}

}  // namespace truestep::sph
