// Springs between points and places on bodies: impulses at both ends of a substep, or solved together with
// both sides when too stiff for that.
#include <algorithm>
#include <cmath>

#include "engine/couplings/attachment/body_attachment.h"
#include "engine/couplings/attachment/links.h"
#include "engine/couplings/attachment/places.h"

namespace truestep::attachment {

namespace {

/// Relative accuracy of the solution.
constexpr double kSpringAccuracy = 1e-12;
/// Fraction of an impulse that the force at the end may differ by.
constexpr double kSolved = 1e-6;
constexpr double kRounding = 1e-15;  ///< of lengths

}  // namespace

// Half a substep's impulse of soft springs: J = -h/2 k (|r| - L) n.
void BodyAttachment::pull(const std::vector<Live>& live, Points& points, Bodies& bodies, double h,
                          Exchange& sum) const {
  for (const Live& l : live) {
    if (!l.kicked) continue;
    const Vec3 r = separation(points, l.link.rows[0], bodies, l.link.body, l.place);
    const Vec3 stretch = l.rest == 0 ? r : r - normalized(r) * l.rest,
               j = stretch * (-0.5 * h * def_.stiffness);
    l.link.push(points, bodies, j);
    sum.add(-j, 0);
  }
}

// du/dt = -c K u along n by the trapezoid rule: u' = u (1 - q) / (1 + q), q = c K h / 4.
void BodyAttachment::damp(const std::vector<Live>& live, Points& points, Bodies& bodies, double h,
                          Exchange& sum) const {
  if (def_.damping == 0) return;
  for (const Live& l : live) {
    if (!l.kicked) continue;
    const uint32_t b = l.link.body;
    const Vec3 r = separation(points, l.link.rows[0], bodies, b, l.place),
               u = l.link.relative(points, bodies);
    if (!(norm2(r) > 0)) continue;
    const Vec3 n = normalized(r);
    const double k = l.link.inverse_mass(points) + bodies.inverse_mass(b, l.link.arm(points, bodies), n);
    const double q = 0.25 * def_.damping * k * h, speed = dot(u, n), j = -2 * q / ((1 + q) * k) * speed;
    l.link.push(points, bodies, n * j);
    sum.add(n * -j, -j * (speed + 0.5 * k * j));
  }
}

// J = -h f(r', u') with f = K r' - k L n + c (u'.n) n; the equations are in attachment_solve.cc. A spring
// without length acts in every direction, one with a length along itself only: what begin() has given beside
// that stays, as it does with rigid links. Newton's method: a stiff spring that the last solution has turned
// is longer.
void BodyAttachment::solve_springs(const CoupledStates& s, const StepInput& in, std::vector<Live>& all,
                                   Exchange& sum) const {
  Points points(this->points(s), sides_.points());
  Bodies bodies(this->bodies(s), sides_.bodies(), &in.workspace);
  auto& links = in.workspace.object<std::vector<AnsweredLink>>("body_attachment.links");
  // N s, in so far; begin() has given the last forces.
  double* impulse = in.workspace.doubles("body_attachment.impulse", 3 * pairs_.size()).data();
  const double k = def_.stiffness, c = def_.damping, h = in.h;
  double* last = pair_forces(s.own);
  for (const Live& l : all) store3(impulse, l.pair, last ? load3(last, 2 * l.pair) * h : Vec3{});
  for (int solution = 0; solution < kMostSolutions; ++solution) {
    links.clear();
    bool solved = true;
    for (const Live& l : all) {
      if (l.kicked) continue;
      const Vec3 r = separation(points, l.link.rows[0], bodies, l.link.body, l.place);
      const Vec3 u = l.link.relative(points, bodies), j0 = load3(impulse, l.pair);
      AnsweredLink a;
      a.link = l.link, a.n = l.rest == 0 ? Vec3{} : normalized(r);
      a.give = 1, a.along = std::sqrt(h * (h * k + c));
      const Vec3 missing = l.rest == 0
                               ? (r * k + u * c) * -h - j0
                               : a.n * (-h * (k * (dot(r, a.n) - l.rest) + c * dot(u, a.n)) - dot(j0, a.n));
      a.across = l.rest == 0 ? a.along : 0;
      a.right = missing / a.along;
      const double rounding = kRounding * h * k * (norm(r) + norm(l.link.place(points)));
      solved = solved && norm(missing) <= kSolved * norm(j0) + rounding;
      links.push_back(a);
    }
    if (links.empty() || solved) break;
    sides_.solve(this->points(s), this->bodies(s), in, links, kSpringAccuracy, 3 * links.size() + 10);
    sides_.move(this->points(s), this->bodies(s), in, links);
    const AnsweredLink* a = links.data();
    for (const Live& l : all) {
      if (l.kicked) continue;
      store3(impulse, l.pair, load3(impulse, l.pair) + a->impulse);
      sum.add(-a->impulse, 0);
      ++a;
    }
  }
  for (const Live& l : all) {
    if (l.kicked) continue;
    const Vec3 r = separation(points, l.link.rows[0], bodies, l.link.body, l.place),
               u = l.link.relative(points, bodies);
    const double u2 = l.rest == 0 ? norm2(u) : dot(u, normalized(r)) * dot(u, normalized(r));
    sum.add({}, h * c * u2);
    if (last) store3(last, 2 * l.pair, load3(impulse, l.pair) / h);
  }
}

}  // namespace truestep::attachment
