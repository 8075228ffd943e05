// What material points give out: energies by the laws' own energy densities, momenta with the affine part of
// Jiang et al. 2015, bounds.
#include <algorithm>
#include <cmath>

#include "engine/core/mass_points.h"
#include "engine/core/outputs/outputs_of.h"
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

/// A number for every particle: value(piece, volume ratio, plastic state).
template <class Value>
auto of_particles(Value value) {
  return computed_by<Mpm>([value](const Mpm& m, const State& s, ShownRows, double* out) {
    const RealColumn<const double> j(s, columns::jacobian), plastic(s, columns::plastic);
    for_runs(m.setting(), s, [&](const Piece& p, size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] = value(p, j.at(i), plastic.at(i));
    });
  });
}

double plastic_strain(const Piece& p, double plastic) {
  return p.material.law == Law::snow ? 1 - plastic : plastic;
}

}  // namespace

struct Mpm::Whole : MassPoints {
  using MassPoints::MassPoints;
  double elastic = 0, plastic = 0, least = HUGE_VAL, most = 0;
  Vec3 angular_momentum;
  std::optional<double> error;
  double energy() const { return kinetic + elastic + height; }
};

const OutputTable& Mpm::outputs() {
  using W = Whole;
  constexpr auto kReal = [](const Mpm& m) {
    return m.setting().def.precision == Precision::f32 ? Scalar::f32 : Scalar::f64;
  };
  constexpr auto kChanges = [](const Mpm& m) { return m.setting().def.changes(); };
  static const OutputTable kTable =
      OutputsOf<Mpm>(
          "a particle, body after body; rows of removed particles are closed up, new ones come at the end")
          .part("", [](const Mpm& m) { return points_part(m.setting().capacity); })
          .rows(present_rows(columns::position))
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(columns::position), "")
          .field_type(kReal)
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(columns::velocity), "")
          .field_type(kReal)
          .field({"density", "kg/m^3"},
                 of_particles([](const Piece& p, double j, double) { return p.density / j; }),
                 "rest density over the volume ratio")
          .field({"plastic_strain", "1"},
                 of_particles([](const Piece& p, double, double q) { return plastic_strain(p, q); }),
                 "snow: 1 - Jp, how much it is packed; sand: volume correction; foam: plastic strain")
          .field({.name = "material",
                  .unit = "1",
                  .kinds = {"fluid", "corotated", "neo_hookean", "snow", "sand", "foam", "elastic"}},
                 of_particles(
                     [](const Piece& p, double, double) { return static_cast<double>(p.material.law); }),
                 "0 fluid, 1 corotated, 2 neo_hookean, 3 snow, 4 sand, 5 foam, 6 elastic")
          .field({"id", "1", Scalar::u64}, column(columns::id),
                 "number that is never reused, if particles come or go")
          .field_when(kChanges)
          .measured(&Mpm::whole, {{"energy.kinetic", "J", &W::kinetic, "of the particles' own velocities"},
                                  {"energy.elastic", "J", &W::elastic, "stored by deformation"},
                                  {"energy.gravity", "J", &W::height, "potential, about the origin"},
                                  {"energy.total", "J", &W::energy, "their sum"},
                                  {"momentum", "kg m/s", &W::momentum},
                                  {"angular_momentum", "kg m^2/s", &W::angular_momentum,
                                   "about the origin, including the affine velocities"},
                                  {"centre", "m", &W::centre, "of mass"},
                                  {"low", "m", &W::lowest, "smallest coordinate of any particle"},
                                  {"high", "m", &W::highest, "largest coordinate of any particle"},
                                  {"plastic.mean", "1", &W::plastic, "of plastic_strain, weighted by mass"},
                                  {"jacobian.min", "1", &W::least, "smallest volume ratio"},
                                  {"jacobian.max", "1", &W::most, "largest volume ratio"},
                                  {"error.exact", "m", &W::error,
                                   "distance of particles from their exact positions, root mean square"},
                                  {"mass", "kg", &W::mass, "of all particles"}})
          .measured(count_rows(columns::position),
                    {{"count", "1", entry<0>, "present particles, if they come or go"}})
          .when(kChanges)
          .measured(
              [](const Mpm&, const State& s, double) { return s.span<uint64_t>(columns::counts); },
              {{"emitted", "1", entry<counts::emitted>, "particles born from nozzles"},
               {"killed", "1", entry<counts::killed>, "particles removed by kill regions"},
               {"refused", "1", entry<counts::refused>, "births refused because max_particles was reached"}})
          .when(kChanges)
          .build();
  return kTable;
}

const Outputs& mpm_outputs() {
  static const Outputs kDescribed = Mpm::outputs().described();
  return kDescribed;
}

Mpm::Whole Mpm::whole(const State& s, double t) const {
  const Setting& set = *setting_;
  const RealColumn<const double> x(s, columns::position), v(s, columns::velocity), c(s, columns::affine),
      f(s, columns::deformation), plastic(s, columns::plastic), jacobian(s, columns::jacobian);
  const auto d = static_cast<size_t>(set.def.dimension);
  const double cell = set.def.cell;
  const double second = (set.def.splines == Splines::quadratic ? 0.25 : 1.0 / 3) * cell * cell;
  const bool affine = set.def.transfer == Transfer::apic;
  Whole out(load3(s.f64(columns::gravity).data(), 0));
  double plastic_mass = 0;
  for_runs(set, s, [&](const Piece& piece, size_t begin, size_t end) {
    const double m = piece.mass;
    out.elastic += piece.volume * (d == 2 ? energy_densities<2>(piece, begin, end, f, jacobian, plastic)
                                          : energy_densities<3>(piece, begin, end, f, jacobian, plastic));
    for (size_t i = begin; i < end; ++i) {
      const Vec3 at = x.vector(i), u = v.vector(i);
      const double j = jacobian.at(i), q = plastic.at(i);
      out.add(m, at, u);
      out.angular_momentum += cross(at, u) * m;
      if (affine) {
        // What the affine velocity around a particle adds (Jiang et al. 2015, section 5.3).
        const auto turn = [&](size_t r, size_t k) {
          return r < d && k < d ? c.at(d * d * i + d * r + k) - c.at(d * d * i + d * k + r) : 0.0;
        };
        out.angular_momentum += Vec3{turn(2, 1), turn(0, 2), turn(1, 0)} * (m * second);
      }
      plastic_mass += m * plastic_strain(piece, q);
      out.least = std::min(out.least, j), out.most = std::max(out.most, j);
    }
  });
  out.plastic = plastic_mass / out.mass;
  if (!set.exact.empty()) out.error = distance_from_exact(set, x, t);
  return out;
}

}  // namespace truestep::mpm
