// Rigid links between points and places on bodies: lengths, velocities along them, and both sides solved as
// one.
#include <algorithm>
#include <cmath>

#include "engine/couplings/attachment/body_attachment.h"
#include "engine/couplings/attachment/links.h"
#include "engine/couplings/attachment/places.h"

namespace truestep::attachment {

namespace {

/// Accuracy of each Newton step.
constexpr double kLinkAccuracy = 1e-12;

}  // namespace

// Newton's method for the lengths at the end, both sides solved as one.
void BodyAttachment::solve_links(const CoupledStates& s, const StepInput& in, std::vector<Live>& all,
                                 Exchange& sum) const {
  Points points(this->points(s), sides_.points());
  Bodies bodies(this->bodies(s), sides_.bodies(), &in.workspace);
  auto& links = in.workspace.object<std::vector<AnsweredLink>>("body_attachment.links");
  double* last = pair_forces(s.own);
  for (int solution = 0; solution < kMostSolutions; ++solution) {
    links.clear();
    double worst = 0;
    for (const Live& l : all) {
      const Vec3 r = separation(points, l.link.rows[0], bodies, l.link.body, l.place);
      AnsweredLink a;
      a.link = l.link;
      a.n = l.rest == 0 ? Vec3{} : normalized(r);
      a.across = l.rest == 0 ? 1 : 0;
      a.right = (l.rest == 0 ? -r : a.n * (l.rest - norm(r))) / in.h;
      worst = std::max(worst, norm(a.right) * in.h / std::max(l.rest, 1.0));
      links.push_back(a);
    }
    if (worst <= kLengthTolerance) break;
    sides_.solve(this->points(s), this->bodies(s), in, links, kLinkAccuracy, 3 * links.size() + 10);
    sides_.move(this->points(s), this->bodies(s), in, links);
    for (size_t k = 0; k < links.size(); ++k) {
      sum.add(-links[k].impulse, 0);
      if (last) store3(last, 2 * all[k].pair, load3(last, 2 * all[k].pair) + links[k].impulse / in.h);
    }
  }
}

// SHAKE's part: every position correction also changes the velocity, by 1/h times as much. The impulse acts
// on the body where the link does; the error in angular momentum left by it and the correction is of second
// order.
void BodyAttachment::restore_lengths(const std::vector<Live>& live, Points& points, Bodies& bodies, double h,
                                     Exchange& sum) const {
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double worst = 0;
    for (const Live& l : live) {
      const uint32_t b = l.link.body;
      const size_t i = l.link.rows[0];
      const Vec3 arm = arm_of(bodies, b, l.place), r = l.link.place(points) - bodies.place(b) - arm;
      const Vec3 dr = length_correction(r, l.start, l.rest);
      worst = std::max(worst, norm(dr) / std::max(l.rest, 1.0));
      const double size = norm(dr);
      if (!(size > 0)) continue;
      const double w = points.inverse_mass(i);
      const Vec3 n = dr / size, p = dr / (w + bodies.inverse_mass(b, arm, n)), j = p / h;
      points.accelerate(i, j * w);
      bodies.push(b, arm, -j);
      const Vec3 gained = (w > 0 ? cross(r, j) : Vec3{}) + l.link.gained(points, bodies, p);
      points.shift(i, p * w);
      bodies.shift(b, arm, -p, w > 0 ? gained : Vec3{});
      sum.add(-j, 0);
    }
    if (worst <= kLengthTolerance) break;
  }
}

// RATTLE's part: u.n = 0, or u = 0 when the two places coincide: then one direction at a time.
void BodyAttachment::match_velocities(const std::vector<Live>& live, Points& points, Bodies& bodies,
                                      Exchange& sum) const {
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double worst = 0, fastest = 0;
    for (const Live& l : live) {
      const Vec3 arm = l.link.arm(points, bodies), u = l.link.relative(points, bodies);
      const Vec3 r = separation(points, l.link.rows[0], bodies, l.link.body, l.place);
      const Vec3 along = l.rest == 0 ? u : normalized(r) * dot(u, normalized(r));
      const double speed = norm(along);
      worst = std::max(worst, speed),
      fastest = std::max(fastest, norm(u) + norm(bodies.velocity(l.link.body)));
      if (!(speed > 0)) continue;
      const Vec3 n = along / speed;
      const double k = l.link.inverse_mass(points) + bodies.inverse_mass(l.link.body, arm, n);
      const Vec3 j = n * (-speed / k);
      l.link.push(points, bodies, j);
      sum.add(-j, 0.5 * speed * speed / k);
    }
    if (worst <= kLengthTolerance * fastest) break;
  }
}

}  // namespace truestep::attachment
