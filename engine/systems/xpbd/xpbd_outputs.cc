// What constrained points give out: energies, momenta and the strains of links.
#include <algorithm>
#include <cmath>

#include "engine/core/outputs/outputs_of.h"
#include "engine/kernels/xpbd/volume.h"
#include "engine/systems/xpbd/xpbd.h"

namespace truestep::xpbd {

using Columns = XpbdColumns;

struct Xpbd::Whole {
  using Maybe = std::optional<double>;
  double kinetic = 0;
  Maybe potential, total;         ///< of scheme xpbd
  Maybe stretch, bending, twist;  ///< of rods
  Vec3 momentum, angular_momentum;
  double largest = 0, mean_square = 0, pins = 0;
  Maybe volume, splits;
};

const OutputTable& Xpbd::outputs() {
  using W = Whole;
  using C = Columns;
  static const OutputTable kTable =
      OutputsOf<Xpbd>(
          "a point: along a rope from its first end, strand by strand in hair, j nx + i in a cloth grid, in "
          "the given order in a mesh, x fastest in a block")
          .part("", [](const Xpbd& x) { return points_part(x.body_.capacity); })
          .rows(present_rows(C::position))
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(C::position), "")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(C::velocity), "")
          .field({"strain", "1"}, computed_by<Xpbd>(&Xpbd::point_strains),
                 "largest |length / rest length - 1| of its links")
          .part("links",
                [](const Xpbd& x) {
                  const size_t n = x.body_.links.size();
                  return n > 0 ? std::optional(values_part(n, PartInfo::Elements::lines)) : std::nullopt;
                })
          .field({"links.strain", "1"}, computed_by<Xpbd>(&Xpbd::link_strains),
                 "of part links, one row per link: length / rest length - 1")
          .measured(
              &Xpbd::whole,
              {{"energy.kinetic", "J", &W::kinetic, "of motion"},
               {"energy.potential", "J", &W::potential,
                "of gravity, user forces and all constraints; scheme xpbd only"},
               {"energy.total", "J", &W::total, "their sum; scheme xpbd only"},
               {"energy.stretch", "J", &W::stretch, "of stretch and shear; rods only"},
               {"energy.bending", "J", &W::bending, "rods only"},
               {"energy.twist", "J", &W::twist, "rods only"},
               {"momentum", "kg m/s", &W::momentum, "of all free points"},
               {"angular_momentum", "kg m^2/s", &W::angular_momentum, "about the origin, of all free points"},
               {"strain.max", "1", &W::largest,
                "largest |length / rest length - 1| of links between neighbours"},
               {"strain.rms", "1", &W::mean_square, "root mean square of the same"},
               {"pins", "1", &W::pins, "points that are pinned"},
               {"volume", "m^3", &W::volume, "of all tetrahedra of blocks"},
               {"splits", "1", &W::splits, "points split off by tearing; only with tear"}})
          .build();
  return kTable;
}

const Outputs& xpbd_outputs() {
  static const Outputs kDescribed = Xpbd::outputs().described();
  return kDescribed;
}

double Xpbd::strain(const double* x, const Link& l, const Strand& strand) {
  return norm(load3(x, strand.b) - load3(x, strand.a)) / l.rest - 1;
}

// visit(link, strand, strain) of all that are not torn.
template <class Visit>
void Xpbd::each_strand(const State& s, const Visit& visit) const {
  const double* x = s.f64(Columns::position).data();
  for (size_t k = 0; k < body_.links.size(); ++k) {
    for (size_t i = 0; i < strands(k); ++i) {
      const Strand strand = this->strand(s, k, i);
      if (strand.share > 0) visit(k, strand, strain(x, body_.links[k], strand));
    }
  }
}

Xpbd::Whole Xpbd::whole(const State& s, double) const {
  const double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  const auto w = s.f64(Columns::inverse_mass), masses = this->masses(s);
  const Energy e = energies(s);
  Whole out;
  out.kinetic = e.kinetic;
  if (options_.scheme == Scheme::xpbd) out.potential = e.potential, out.total = e.kinetic + e.potential;
  if (cosserat_) {
    const Vec3 rods = rod_energies(s);
    out.stretch = rods.x, out.bending = rods.y, out.twist = rods.z;
  }
  for (size_t i = 0; i < w.size(); ++i) {
    if (!(w[i] > 0)) {
      out.pins += 1;
      continue;
    }
    const Vec3 mv = masses[i] * load3(v, i);
    out.momentum += mv, out.angular_momentum += cross(load3(x, i), mv);
  }
  add_turning(s, out.angular_momentum);
  double squares = 0;
  size_t count = 0;
  each_strand(s, [&](size_t k, const Strand&, double strain) {
    if (body_.links[k].family != Family::structural) return;
    const double c = std::abs(strain);
    out.largest = std::max(out.largest, c), squares += c * c, ++count;
  });
  if (count > 0) out.mean_square = std::sqrt(squares / static_cast<double>(count));
  if (!body_.tetrahedra.empty()) {
    double volumes = 0;
    for (const Tetrahedron& t : body_.tetrahedra) {
      const auto& q = t.points;
      volumes += volume(load3(x, q[0]), load3(x, q[1]), load3(x, q[2]), load3(x, q[3]));
    }
    out.volume = volumes;
  }
  if (tears_) out.splits = static_cast<double>(w.size() - body_.x.size());
  return out;
}

void Xpbd::add_turning(const State& s, Vec3& angular_momentum) const {
  for (size_t f = 0; f < rods_.frames.size(); ++f) {
    const size_t r = f / (rods_.links + 2), j = f % (rods_.links + 2);
    if (j == 0 || j > rods_.links) continue;
    const double* q = s.f64(rods_.orientation).data() + 4 * f;
    const Vec3 o = load3(s.f64(rods_.spin).data(), f), &i = rods_.inertia[r * rods_.links + j - 1];
    angular_momentum += rotation(Quat{q[0], q[1], q[2], q[3]}).apply({i.x * o.x, i.y * o.y, i.z * o.z});
  }
}

void Xpbd::link_strains(const State& s, ShownRows rows, double* out) const {
  std::fill_n(out, rows.count, 0.0);
  each_strand(s, [&](size_t k, const Strand&, double c) {
    if (std::abs(c) >= std::abs(out[k])) out[k] = c;
  });
}

void Xpbd::point_strains(const State& s, ShownRows rows, double* out) const {
  std::fill_n(out, rows.count, 0.0);
  each_strand(s, [&](size_t, const Strand& strand, double c) {
    for (const uint32_t p : {strand.a, strand.b}) out[p] = std::max(out[p], std::abs(c));
  });
}

}  // namespace truestep::xpbd
