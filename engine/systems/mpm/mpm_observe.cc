// Observables of a state: energies by the laws' own energy densities, momenta with the affine part of Jiang
// et al. 2015, bounds; and their descriptions.
#include <algorithm>
#include <cmath>

#include "engine/core/mass_points.h"
#include "engine/systems/mpm/mpm.h"

namespace truestep::mpm {

namespace {

/// Elastic energy of a piece per undeformed volume of a particle, summed over its particles in their order.
template <int D>
double energy_densities(const Piece& piece, size_t begin, size_t end, const RealColumn<const double>& f,
                        const RealColumn<const double>& j, const RealColumn<const double>& plastic) {
  using W = Wide<double>;
  double sum = 0;
  for (size_t i = begin; i < end; i += W::kLanes) {
    const size_t count = std::min<size_t>(W::kLanes, end - i);
    Square<D, double> a = Square<D, double>::identity();
    W volume = W::all(1), flown = W::all(1);
    for (size_t lane = 0; lane < count; ++lane) {
      const int at = static_cast<int>(lane);
      for (size_t k = 0; k < D * D; ++k) a.m[k].set(at, f.at(D * D * (i + lane) + k));
      volume.set(at, j.at(i + lane)), flown.set(at, plastic.at(i + lane));
    }
    const W energy = response(piece, a, volume, flown).energy;
    for (size_t lane = 0; lane < count; ++lane) sum += energy[static_cast<int>(lane)];
  }
  return sum;
}

/// Root mean square over particles, m.
double distance_from_exact(const Setting& set, const RealColumn<const double>& x, double t) {
  constexpr size_t kMost = PlaceTexts::kMost;
  const auto d = static_cast<size_t>(set.def.dimension);
  double sum = 0, from[3][kMost], to[3][kMost];
  for (size_t b = 0; b < set.def.bodies.size(); ++b) {
    const std::vector<Vec3> places = places_of(set.def, set.def.bodies[b]);
    for (size_t first = 0; first < places.size(); first += kMost) {
      const size_t many = std::min(kMost, places.size() - first);
      for (size_t k = 0; k < many; ++k) {
        const Vec3& p = places[first + k];
        from[0][k] = p.x, from[1][k] = p.y, from[2][k] = p.z;
      }
      set.exact.run(t, from[0], from[1], from[2], many, to[0], kMost);
      for (size_t a = 0; a < d; ++a) {
        for (size_t k = 0; k < many; ++k) {
          const double off = x.at(3 * (set.pieces[b].first + first + k) + a) - to[a][k];
          sum += off * off;
        }
      }
    }
  }
  return std::sqrt(sum / static_cast<double>(set.rows()));
}

}  // namespace

void Mpm::observe(const State& s, double t, Observables& out) const {
  const Setting& set = *setting_;
  const RealColumn<const double> x(s, columns::position), v(s, columns::velocity), c(s, columns::affine),
      f(s, columns::deformation), plastic(s, columns::plastic), jacobian(s, columns::jacobian);
  const auto d = static_cast<size_t>(set.def.dimension);
  const double cell = set.def.cell;
  const double second = (set.def.splines == Splines::quadratic ? 0.25 : 1.0 / 3) * cell * cell;
  const bool affine = set.def.transfer == Transfer::apic;
  MassPoints all(load3(s.f64(columns::gravity).data(), 0));
  double elastic = 0, strain = 0, least = HUGE_VAL, most = 0;
  Vec3 l;
  for_runs(set, s, [&](const Piece& piece, size_t begin, size_t end) {
    const double m = piece.mass;
    elastic += piece.volume * (d == 2 ? energy_densities<2>(piece, begin, end, f, jacobian, plastic)
                                      : energy_densities<3>(piece, begin, end, f, jacobian, plastic));
    for (size_t i = begin; i < end; ++i) {
      const Vec3 at = x.vector(i), u = v.vector(i);
      const double j = jacobian.at(i), q = plastic.at(i);
      all.add(m, at, u);
      l += cross(at, u) * m;
      if (affine) {
        // What the affine velocity around a particle adds (Jiang et al. 2015, section 5.3).
        const auto turn = [&](size_t r, size_t k) {
          return r < d && k < d ? c.at(d * d * i + d * r + k) - c.at(d * d * i + d * k + r) : 0.0;
        };
        l += Vec3{turn(2, 1), turn(0, 2), turn(1, 0)} * (m * second);
      }
      strain += m * (piece.material.law == Law::snow ? 1 - q : q);
      least = std::min(least, j), most = std::max(most, j);
    }
  });
  const size_t n = s.rows(columns::position);
  out.add("energy.kinetic", all.kinetic, "J");
  out.add("energy.elastic", elastic, "J");
  out.add("energy.gravity", all.height, "J");
  out.add("energy.total", all.kinetic + elastic + all.height, "J");
  add_vector(out, "momentum", all.momentum, "kg m/s");
  add_vector(out, "angular_momentum", l, "kg m^2/s");
  all.observe_centre(out);
  all.observe_extent(out);
  out.add("plastic.mean", strain / all.mass, "1");
  out.add("jacobian.min", least, "1");
  out.add("jacobian.max", most, "1");
  if (!set.exact.empty()) out.add("error.exact", distance_from_exact(set, x, t), "m");
  out.add("mass", all.mass, "kg");
  if (!set.def.changes()) return;
  const auto c_of = s.span<uint64_t>(columns::counts);
  out.add("count", static_cast<double>(n), "1");
  out.add("emitted", static_cast<double>(c_of[counts::emitted]), "1");
  out.add("killed", static_cast<double>(c_of[counts::killed]), "1");
  out.add("refused", static_cast<double>(c_of[counts::refused]), "1");
}

const Outputs& mpm_outputs() {
  static const Outputs kOutputs{
      .rows =
          "a particle, body after body; rows of removed particles are closed up, new ones come at the end",
      .fields = {{"position", "m", 3, ""},
                 {"velocity", "m/s", 3, ""},
                 {"density", "kg/m^3", 1, "rest density over the volume ratio"},
                 {"plastic_strain", "1", 1,
                  "snow: 1 - Jp, how much it is packed; sand: volume correction; foam: plastic strain"},
                 {"material", "1", 1,
                  "0 fluid, 1 corotated, 2 neo_hookean, 3 snow, 4 sand, 5 foam, 6 elastic"},
                 {"id", "1", 1, "number that is never reused, if particles come or go"}},
      .observables = {
          {"energy.kinetic", "J", "of the particles' own velocities"},
          {"energy.elastic", "J", "stored by deformation"},
          {"energy.gravity", "J", "potential, about the origin"},
          {"energy.total", "J", "their sum"},
          {"momentum.x", "kg m/s", ""},
          {"momentum.y", "kg m/s", ""},
          {"momentum.z", "kg m/s", ""},
          {"angular_momentum.x", "kg m^2/s", "about the origin, including the affine velocities"},
          {"angular_momentum.y", "kg m^2/s", ""},
          {"angular_momentum.z", "kg m^2/s", ""},
          {"centre.x", "m", "of mass"},
          {"centre.y", "m", ""},
          {"centre.z", "m", ""},
          {"low.x", "m", "smallest coordinate of any particle"},
          {"low.y", "m", ""},
          {"low.z", "m", ""},
          {"high.x", "m", "largest coordinate of any particle"},
          {"high.y", "m", ""},
          {"high.z", "m", ""},
          {"plastic.mean", "1", "of plastic_strain, weighted by mass"},
          {"jacobian.min", "1", "smallest volume ratio"},
          {"jacobian.max", "1", "largest volume ratio"},
          {"error.exact", "m", "distance of particles from their exact positions, root mean square"},
          {"mass", "kg", "of all particles"},
          {"count", "1", "present particles, if they come or go"},
          {"emitted", "1", "particles born from nozzles"},
          {"killed", "1", "particles removed by kill regions"},
          {"refused", "1", "births refused because max_particles was reached"}}};
  return kOutputs;
}

}  // namespace truestep::mpm
