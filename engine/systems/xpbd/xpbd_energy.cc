// Energies of an xpbd state. Potential energy is that of gravity, of drag springs and of
// all constraints, 1/2 C^2 / alpha each; projections without compliance (scheme pbd) have none.
#include <algorithm>
#include <cmath>

#include "engine/kernels/xpbd/dihedral.h"
#include "engine/kernels/xpbd/membrane.h"
#include "engine/kernels/xpbd/neo_hookean.h"
#include "engine/kernels/xpbd/volume.h"
#include "engine/systems/xpbd/xpbd.h"

namespace truestep::xpbd {

using Columns = XpbdColumns;

double Xpbd::elastic(const State& s) const {
  const double* x = s.f64(Columns::position).data();
  const auto stiffness = s.f64(Columns::stiffness);
  const double bending = stiffness[static_cast<size_t>(Family::bending)];
  double v = 0;
  if (cosserat_) {
    const Vec3 e = rod_energies(s);
    return e.x + e.y + e.z;
  }
  if (!matches_.empty()) return matches_.energy(x);
  for (size_t k = 0; k < body_.links.size() && !elastic_ && !membrane_; ++k) {
    const Link& l = body_.links[k];
    for (size_t i = 0; i < strands(k); ++i) {
      const Strand strand = this->strand(s, k, i);
      const double c = norm(load3(x, strand.b) - load3(x, strand.a)) - l.rest;
      v += 0.5 * stiffness[static_cast<size_t>(l.family)] * l.factor * strand.share * c * c;
    }
  }
  const auto torn = [&](const auto& points) {
    return tears_ && std::any_of(points.begin(), points.end(), [&](uint32_t p) {
             return tears_->split(s.span<uint32_t>(tears_->columns.corner), p);
           });
  };
  const auto add_linear = [&](const auto& bends) {
    for (const auto& b : bends) {
      if (torn(b.points)) continue;
      Vec3 c;
      for (size_t i = 0; i < b.points.size(); ++i) c += load3(x, b.points[i]) * b.k[i];
      v += 0.5 * bending * b.factor * norm2(c);
    }
  };
  add_linear(body_.rods);
  add_linear(body_.hinges);
  for (const AngleBend& b : body_.angles) {
    if (torn(b.points)) continue;
    const auto& p = b.points;
    const Dihedral d = dihedral(load3(x, p[0]), load3(x, p[1]), load3(x, p[2]), load3(x, p[3]));
    const double c = turned(d.angle, b.rest);
    v += 0.5 * bending * b.factor * c * c;
  }
  for (const SheetTriangle& t : body_.sheet) {
    const auto [f1, f2] = deformation(t, x);
    const auto& energy =
        options_.membrane == Membrane::neo_hookean ? neo_hookean_membrane : st_venant_kirchhoff_membrane;
    v += stiffness_of(stiffness, Family::structural) * t.volume * energy(f1, f2, options_.sheet_ratio);
  }
  for (const Tetrahedron& t : body_.tetrahedra) {
    const auto& p = t.points;
    if (elastic_) {
      const double nu = *options_.poisson_ratio;
      const double mu = 0.5 * stiffness[static_cast<size_t>(Family::volume)] / (1 + nu);
      const Vec3 o = load3(x, p[0]), a = load3(x, p[1]) - o, b = load3(x, p[2]) - o, c = load3(x, p[3]) - o;
      const Mat3 edges{{a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z}};
      v += neo_hookean_energy(edges * t.inverse, t.rest, mu, 1 - 2 * nu);
      continue;
    }
    const double c = volume(load3(x, p[0]), load3(x, p[1]), load3(x, p[2]), load3(x, p[3])) - t.rest;
    v += 0.5 * stiffness[static_cast<size_t>(Family::volume)] / t.rest * c * c;
  }
  return v;
}

Vec3 Xpbd::rod_energies(const State& s) const {
  Vec3 out;
  if (!cosserat_) return out;
  const double *x = s.f64(Columns::position).data(), *q = s.f64(rods_.orientation).data();
  const auto w = s.f64(Columns::inverse_mass);
  const auto frame = [&](size_t i) { return Quat{q[4 * i], q[4 * i + 1], q[4 * i + 2], q[4 * i + 3]}; };
  const Vec3 k = rods_.stretching(), b = rods_.bending();
  for (size_t r = 0; r < rods_.rods; ++r) {
    const size_t p = rods_.first_point(r), f = rods_.first_frame(r);
    for (size_t j = 0; j <= rods_.links; ++j) {
      if (rods_.holds(j, w[p + j])) {
        const double l = rods_.joint_length(r, j);
        const Vec3 o =
            bend_and_twist(frame(f + j), frame(f + j + 1), l) - rods_.rest[rods_.first_joint(r) + j];
        out.y += 0.5 * l * (b.x * o.x * o.x + b.y * o.y * o.y), out.z += 0.5 * l * b.z * o.z * o.z;
      }
      if (j == rods_.links) break;
      const double l = rods_.length[r * rods_.links + j];
      const Vec3 g = stretch_and_shear(load3(x, p + j + 1) - load3(x, p + j), frame(f + j + 1), l);
      out.x += 0.5 * l * (k.x * g.x * g.x + k.y * g.y * g.y + k.z * g.z * g.z);
    }
  }
  return out;
}

Energy Xpbd::energies(const State& s) const {
  const double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  const auto w = s.f64(Columns::inverse_mass), masses = this->masses(s);
  const Vec3 g = load3(s.f64(Columns::gravity).data(), 0);
  Energy e;
  for (size_t i = 0; i < w.size(); ++i) {
    if (w[i] > 0) e.kinetic += 0.5 * masses[i] * norm2(load3(v, i));
    e.potential -= masses[i] * dot(g, load3(x, i));
  }
  const double springs = options_.scheme == Scheme::xpbd ? elastic(s) : 0;
  e.potential += springs;
  for (size_t r = 0; r < rods_.rods; ++r) {
    for (size_t j = 0; j < rods_.links; ++j) {
      const Vec3 o = load3(s.f64(rods_.spin).data(), rods_.first_frame(r) + j + 1);
      const Vec3& i = rods_.inertia[r * rods_.links + j];
      e.kinetic += 0.5 * (i.x * o.x * o.x + i.y * o.y * o.y + i.z * o.z * o.z);
    }
  }
  for (size_t k = 0; k < Columns::kHands.drags(s); ++k) {
    const UserForces::Drag drag = Columns::kHands.drag(s, k);
    e.potential += 0.5 * drag.stiffness * norm2(drag.target - load3(x, drag.who));
  }
  // Only single chains store exactly the energy they were given: where sweeps do not converge in a substep,
  // stiff links are stretched by the residual, and that energy is not the motion's.
  const bool exact = !cosserat_ && !elastic_ && tethers_.empty() && body_.rods.empty() &&
                     schedule_.chains.colours.size() == 1;
  if (!exact) e.residual = springs;
  const bool stored = matches_.empty() && options_.scheme == Scheme::xpbd;
  const bool driven = Columns::kHands.any(s) || !colliders_.empty() || folds_ || air_ || !stored;
  e.exchange = driven ? Energy::Exchange::open : Energy::Exchange::closed;
  return e;
}

std::optional<Energy> Xpbd::energy(const State& s, double, Workspace&, const ThreadArena&) const {
  return energies(s);
}

std::optional<double> Xpbd::limit(Limit which, const State&, double) const {
  if (which == Limit::step_seconds) return step_seconds_;
  return which == Limit::speed ? std::optional(speed_limit_) : std::nullopt;
}

// A link of stiffness k between points of mass m pulls no harder than m C / h^2: with h^2 k > m it is softer
// for what presses on its points than the energy that it stores. A body lighter than a point asks for less.
// Elastic blocks and sheets are divided by their own stiffness.
double Xpbd::pressed_h(double mass) const {
  double shortest = substep_;
  if (elastic_ || membrane_ || cosserat_ || options_.scheme != Scheme::xpbd) return shortest;
  std::vector<double> stiffness(body_.x.size());
  for (const Link& l : body_.links) {
    const double k = stiffness_of(body_.stiffness, l.family) * l.factor;
    stiffness[l.a] += k, stiffness[l.b] += k;
  }
  for (size_t i = 0; i < stiffness.size(); ++i) {
    const double m = body_.masses[i];
    if (stiffness[i] > 0)
      shortest = std::min(shortest, std::sqrt(m / stiffness[i] * std::max(1.0, m / mass)));
  }
  return shortest;
}

}  // namespace truestep::xpbd
