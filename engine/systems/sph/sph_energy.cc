// The energy of a liquid's state, and when its density is too far off.
#include <algorithm>
#include <cmath>

#include "engine/base/text/short_number.h"
#include "engine/core/state/real_column.h"
#include "engine/systems/sph/sph.h"

namespace truestep::sph {

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

// A mean density error above 1 %: more than weakly compressible flow should have (Monaghan 1994), and above
// the usual tolerances of solves. The number of spacings crossed needs no check: long steps are divided.
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

}  // namespace truestep::sph
