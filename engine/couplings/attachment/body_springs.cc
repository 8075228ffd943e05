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
constexpr double kAccuracy = 1e-12;
/// Smallest stretch for which a spring's transverse part is solved: the impulse given at the start has a
/// direction, too.
constexpr double kLeastTurned = 1e-9;

}  // namespace

bool BodyAttachment::may_be_kicked(const Live& l, const Points& points, const Bodies& bodies,
                                   double h) const {
  // Bound: one over the mass plus one over the inertia at the arm.
  const uint32_t b = l.link.body;
  double k = l.link.inverse_mass(points);
  if (!bodies.free()) {
    const Vec3 arm = arm_of(bodies, b, l.place);
    for (const Vec3& n : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) k += bodies.inverse_mass(b, arm, n);
  } else if (bodies.dynamic(b)) {
    const BodyForm& f = bodies.form(b);
    const double least = std::min({f.moments.x, f.moments.y, f.moments.z});
    k += 1 / f.mass + norm2(l.place) / least;
  }
  double share = 0;
  for (const Pair& p : pairs_) share += p.point == pairs_[l.pair].point || p.body == pairs_[l.pair].body;
  return h * h * def_.stiffness * k * share <= (sides_.together() ? kMostKickedTogether : kMostKicked);
}

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

// J = -h f(r', u') with f = K r' - k L n + c (u'.n) n; the equations are in attachment_solve.cc.
void BodyAttachment::solve_springs(const CoupledStates& s, const StepInput& in, std::vector<Live>& all,
                                   Exchange& sum) const {
  Points points(this->points(s), sides_.points());
  Bodies bodies(this->bodies(s), sides_.bodies(), &in.workspace);
  auto& links = in.workspace.object<std::vector<AnsweredLink>>("body_attachment.links");
  links.clear();
  const double k = def_.stiffness, c = def_.damping, h = in.h;
  double* last = pair_forces(s.own);  // what begin() has given
  for (const Live& l : all) {
    if (l.kicked) continue;
    const Vec3 r = separation(points, l.link.rows[0], bodies, l.link.body, l.place);
    const Vec3 u = l.link.relative(points, bodies), j0 = last ? load3(last, 2 * l.pair) * h : Vec3{};
    AnsweredLink a;
    a.link = l.link, a.n = l.rest == 0 ? Vec3{} : normalized(r);
    a.give = 1, a.along = std::sqrt(h * (h * k + c));
    if (l.rest == 0) {
      a.across = a.along;
      a.right = (r * k + u * c) * (-h / a.along) - j0 / a.along;
    } else {
      a.across = h * std::sqrt(k * std::max(kLeastTurned, 1 - l.rest / std::max(norm(r), l.rest)));
      const double along = dot(j0, a.n);
      a.right = a.n * (-h / a.along * (k * (dot(r, a.n) - l.rest) + c * dot(u, a.n)) - along / a.along) -
                (j0 - a.n * along) / a.across;
    }
    links.push_back(a);
  }
  if (links.empty()) return;
  sides_.solve(this->points(s), this->bodies(s), in, links, kAccuracy, 3 * links.size() + 10);
  sides_.move(this->points(s), this->bodies(s), in, links);
  const AnsweredLink* a = links.data();
  for (const Live& l : all) {
    if (l.kicked) continue;
    const Vec3 u = a->link.relative(points, bodies);
    const double u2 = a->n == Vec3{} ? norm2(u) : dot(u, a->n) * dot(u, a->n);
    sum.add(-a->impulse, h * c * u2);
    if (last) store3(last, 2 * l.pair, load3(last, 2 * l.pair) + a->impulse / h);
    ++a;
  }
}

}  // namespace truestep::attachment
