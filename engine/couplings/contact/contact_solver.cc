#include "engine/couplings/contact/contact_solver.h"

#include <algorithm>

#include "engine/kernels/contact/contact_response.h"

namespace truestep::contact {

namespace {

/// Sweeps over the touches after the first: points between several solids need several.
constexpr int kSettlingSweeps = 6;
/// How often, on average, a touch may return to the queue before it is answered out of turn.
constexpr size_t kMostDelays = 8;
/// m; overlap that may remain.
constexpr double kSettled = 1e-10;

}  // namespace

PointContactSolver::PointContactSolver(const ContactDef& law, const ContactQuery& q, Points& points,
                                       Points& other, ContactSolverScratch& scratch)
    : law_(law), q_(q), p_(points), o_(other), pt_(q.points.traces), ot_(q.other.traces), scratch_(scratch) {
  scratch_.answered.clear();
  scratch_.contacts.clear();
}

Vec3 PointContactSolver::relative_acceleration(const ContactPair& c) const {
  Vec3 a = q_.points.acceleration(c.point, q_.h);
  for (size_t i = 0; i < c.corners.count; ++i) {
    a -= q_.other.acceleration(c.corners.rows[i], q_.h) * c.b[i];
  }
  return a;
}

// At the time of the touch, u and the relative acceleration a decide between bounce, support and nothing.
bool PointContactSolver::answer(const ContactPair& c, const HullContact& at) {
  const double left = (1 - at.s) * q_.h;
  const Vec3 a = relative_acceleration(c), u = c.relative(p_.v, o_.v) - a * left, n = at.n;
  const double approach = -dot(u, n), pull = -dot(a, n);
  // Separates and does not come back within the substep.
  if (approach <= 0 && -approach >= 0.5 * pull * left) return false;

  Vec3 jump, force;  // of u at the touch, of a after it
  double work;       // of the contact, times K
  // A bounce whose flight 2 e u / a ends within the substep counts as rest.
  if (approach > law_.rest_speed && law_.restitution * approach > 0.51 * pull * q_.h) {
    const Vec3 after = impact(u, n, law_.restitution, law_.friction);
    jump = after - u;
    work = 0.5 * dot(jump, u + after);
  } else {
    Support<double> held = support(u, a, n, law_.friction, left);
    // A pull away from the contact is not resisted.
    if (pull < 0) held.acceleration -= n * pull;
    jump = held.velocity - u, force = held.acceleration - a;
    work = 0.5 * dot(jump, u + held.velocity) +
           dot(force, held.velocity * left + held.acceleration * (0.5 * left * left));
  }
  const auto touch = [&](const MovingPoints& p, size_t row) {
    p.traces.touch(row, at.s, p.path(row, q_.h).at(at.s), p.free_velocity(row), round_);
  };
  touch(q_.points, c.point);
  for (size_t i = 0; i < c.corners.count; ++i) touch(q_.other, c.corners.rows[i]);
  const Vec3 dv = jump + force * left;
  c.change(p_.v, o_.v, dv);
  c.change(p_.x, o_.x, jump * left + force * (0.5 * left * left));
  // Later touches of these rows see the support. Friction may stop the sliding within an instant, and counts
  // as a jump.
  c.change(pt_.end(), ot_.end(), n * (dot(force, n) * q_.h));
  exchange_.add(dv / -c.k, -work / c.k);
  return true;
}

// Cleanup: points still within reach at the substep's end are stopped and moved apart, on the side from which
// they touched.
bool PointContactSolver::settle(const Touch& t, HullContact& at) {
  const SolidList::Corners corners = q_.solids.corners(t.solid);
  std::array<Vec3, 3> x;
  for (size_t i = 0; i < corners.count; ++i) x[i] = load3(o_.x, corners.rows[i]);
  HullContact now = hull_distance(load3(p_.x, t.point), x, corners.count, -at.n);
  // Only a point that faces the other side across a face has passed it; around edges the direction just
  // turns.
  const bool over_face = corners.count == 3 && now.w[0] > 0 && now.w[1] > 0 && now.w[2] > 0;
  if (over_face && dot(now.n, at.n) < 0) now.apart = -now.apart, now.n = -now.n;
  const double overlap = q_.reach - now.apart;
  if (overlap <= kSettled) return false;
  const ContactPair c(p_, o_, t.point, corners, now.w);
  if (c.k == 0) return false;
  at.n = now.n;
  const Vec3 u = c.relative(p_.v, o_.v);
  if (dot(u, now.n) < 0) {
    const Vec3 after = impact(u, now.n, 0.0, law_.friction), dv = after - u;
    c.change(p_.v, o_.v, dv);
    exchange_.add(dv / -c.k, -0.5 * dot(dv, u + after) / c.k);
  }
  c.change(p_.x, o_.x, now.n * overlap);
  return true;
}

size_t PointContactSolver::answer_all(const std::vector<Touch>& touches, uint32_t round) {
  round_ = round;
  // Earlier answers delay or cancel later touches: one that now happens later than it was found goes back
  // into the queue.
  const auto later = [](const Touch& a, const Touch& b) { return touch_order(b, a); };
  std::vector<Touch>& queue = scratch_.queue;
  queue.assign(touches.begin(), touches.end());
  std::make_heap(queue.begin(), queue.end(), later);
  size_t acted = 0, most = kMostDelays * touches.size();
  while (!queue.empty()) {
    std::pop_heap(queue.begin(), queue.end(), later);
    const Touch t = queue.back();
    queue.pop_back();
    const auto at = touch_of(q_, t);
    if (!at) continue;
    if (at->s > t.s && !queue.empty() && at->s > queue.front().s && most > 0) {
      --most;
      queue.push_back({at->s, t.point, t.solid});
      std::push_heap(queue.begin(), queue.end(), later);
      continue;
    }
    const ContactPair c(p_, o_, t.point, q_.solids.corners(t.solid), at->w);
    if (c.k == 0) continue;
    acted += answer(c, *at);
    scratch_.answered.push_back(t);
    scratch_.contacts.push_back(*at);
  }
  return acted;
}

void PointContactSolver::finish() {
  for (const Touch& t : scratch_.answered) {
    pt_.forget(t.point);
    const SolidList::Corners corners = q_.solids.corners(t.solid);
    for (size_t i = 0; i < corners.count; ++i) ot_.forget(corners.rows[i]);
  }
  for (int sweep = 0; sweep < kSettlingSweeps; ++sweep) {
    bool moved = false;
    for (size_t k = 0; k < scratch_.answered.size(); ++k) {
      moved |= settle(scratch_.answered[k], scratch_.contacts[k]);
    }
    if (!moved) break;
  }
}

}  // namespace truestep::contact
