#include "engine/couplings/contact/body_touch_solver.h"

#include <algorithm>
#include <cmath>

namespace truestep::contact {

namespace {

/// Maximum number of sweeps: points stacked through a light body need several.
constexpr int kSweeps = 40;
/// m and m/s by which the last sweep may change a touch.
constexpr double kSettledGap = 1e-10, kSettledSpeed = 1e-9;
/// Energy that answers may add, as a share of what bounces: sweeps stop before the last bit.
constexpr double kGain = 0.01;

Vec3 times(const double* m, const Vec3& a) {
  return {m[0] * a.x + m[1] * a.y + m[2] * a.z, m[3] * a.x + m[4] * a.y + m[5] * a.z,
          m[6] * a.x + m[7] * a.y + m[8] * a.z};
}

/// The tangential change that removes `slip`, within Coulomb's cone; returns the new sum.
Vec3 rubbed(const SolvedTouch& s, const Vec3& sum, const Vec3& slip, double most) {
  const double l = norm(slip);
  if (!(l > 0)) return sum;
  const Vec3 t = slip / l, wanted = sum - t * (l / dot(t, times(s.mass, t)));
  const double size = norm(wanted);
  return size > most ? wanted * (most / size) : wanted;
}

}  // namespace

double BodyTouchSolver::gap(const BodyTouch& t, const Points& points, const Bodies& bodies) {
  const uint32_t b = t.link.body;
  const Vec3 place = bodies.place(b) + rotation(bodies.orientation(b)).apply(t.place);
  return dot(t.n, t.link.place(points) - place) - t.reach;
}

Vec3 BodyTouchSolver::pull(const BodyTouch& t, const BodyTouchQuery& q, double h) {
  return t.link.blend([&](size_t i) { return (load3(q.start.free_v(), i) - load3(q.start.v(), i)) / h; }) -
         q.body_start.acceleration(t.link.body, t.link.arm(q.points, q.bodies), h);
}

void BodyTouchSolver::weigh(SolvedTouch& s) const {
  const BodyLink& l = s.touch.link;
  const Vec3 arm = l.arm(points_, bodies_);
  const double w = l.inverse_mass(points_);
  const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int j = 0; j < 3; ++j) {
    Vec3 column = axes[j] * w;
    if (l.answers == BodyLink::Body::moves) column += bodies_.answer(l.body, arm, axes[j]);
    s.mass[j] = column.x, s.mass[3 + j] = column.y, s.mass[6 + j] = column.z;
  }
  s.normal = dot(s.touch.n, times(s.mass, s.touch.n));
}

void BodyTouchSolver::prepare(const BodyTouch& t, const BodyTouchQuery& q, Bounces bounces,
                              SolvedTouch& s) const {
  s = {};
  s.touch = t;
  const BodyLink& l = t.link;
  weigh(s);
  const double now = gap(t, points_, bodies_);
  s.pull = pull(t, q, h_);
  if (now <= 0) s.kind = SolvedTouch::Kind::touches;
  if (bounces == Bounces::no || !(t.s < 1) || now > 0) return;
  const double left = (1 - t.s) * h_;
  const double along = dot(t.n, s.pull), speed = dot(t.n, l.relative(points_, bodies_));
  const double approach = along * left - speed;
  // A bounce whose flight 2 e u / a ends within the substep counts as rest.
  if (!(approach > law_.rest_speed) || law_.restitution * approach <= 0.51 * -along * h_) return;
  const double jump = (1 + law_.restitution) * approach;
  s.kind = SolvedTouch::Kind::bounces;
  s.speed = speed + jump;
  s.gap = now + jump * left;
}

double BodyTouchSolver::place(SolvedTouch& s, Exchange& out) {
  const BodyTouch& t = s.touch;
  const double missing = s.gap - gap(t, points_, bodies_);
  const double push = std::max(0.0, s.push + missing / s.normal);
  Vec3 by = t.n * (push - s.push);
  s.push = push;
  if (push > 0 && s.kind == SolvedTouch::Kind::near) s.kind = SolvedTouch::Kind::touches;
  if (law_.friction > 0 && s.kind == SolvedTouch::Kind::touches) {
    const uint32_t b = t.link.body;
    const Vec3 from = bodies_.place(b) + rotation(bodies_.orientation(b)).apply(t.from);
    const Vec3 slid = t.link.place(points_) - from;
    const Vec3 drag = rubbed(s, s.drag, slid - t.n * dot(t.n, slid), law_.friction * push);
    by += drag - s.drag;
    s.drag = drag;
  }
  if (by == Vec3{}) return 0;
  t.link.shift(points_, bodies_, by);
  // The work of a correction against the substep's forces is returned by the velocities that it stops.
  out.energy_lost += dot(by, s.pull);
  return norm(by) * s.normal;
}

double BodyTouchSolver::stop(SolvedTouch& s, Exchange& out) {
  const BodyTouch& t = s.touch;
  const Vec3 u = t.link.relative(points_, bodies_);
  const double un = dot(t.n, u), impulse = std::max(0.0, s.impulse + (s.speed - un) / s.normal);
  Vec3 by = t.n * (impulse - s.impulse);
  s.impulse = impulse;
  if (law_.friction > 0) {
    const Vec3 rub = rubbed(s, s.rub, u - t.n * un, law_.friction * impulse);
    by += rub - s.rub;
    s.rub = rub;
  }
  if (by == Vec3{}) return 0;
  t.link.push(points_, bodies_, by);
  // From the velocities themselves: corrections of places have turned the body since its masses were
  // computed.
  out.add(-by, -dot(by, u + t.link.relative(points_, bodies_)) * 0.5);
  return norm(by) * s.normal;
}

void BodyTouchSolver::sweep(std::vector<SolvedTouch>& solved, Exchange& out) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double worst = 0;
    for (SolvedTouch& s : solved) worst = std::max(worst, place(s, out));
    if (worst <= kSettledGap) break;
  }
  // Corrections turn bodies: with the masses of before, sweeps of impulses may grow instead of settling.
  for (SolvedTouch& s : solved) weigh(s);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double worst = 0;
    for (SolvedTouch& s : solved) {
      if (s.kind != SolvedTouch::Kind::near) worst = std::max(worst, stop(s, out));
    }
    if (worst <= kSettledSpeed) break;
  }
}

void BodyTouchSolver::take_back(SolvedTouch& s) {
  const auto undo = [&](double along, const Vec3& across) { return -(s.touch.n * along + across); };
  s.touch.link.push(points_, bodies_, undo(s.impulse, s.rub));
  s.touch.link.shift(points_, bodies_, undo(s.push, s.drag));
  s.impulse = s.push = s.gap = s.speed = 0, s.rub = s.drag = {};
  if (s.kind == SolvedTouch::Kind::bounces) s.kind = SolvedTouch::Kind::touches;
}

size_t BodyTouchSolver::run(const std::vector<BodyTouch>& touches, const BodyTouchQuery& q, Bounces bounces,
                            std::vector<SolvedTouch>& solved, Exchange& out) {
  solved.clear();
  for (const BodyTouch& t : touches) {
    SolvedTouch s;
    prepare(t, q, bounces, s);
    if (s.normal > 0) solved.push_back(s);
  }
  const Exchange before = out;
  sweep(solved, out);
  double bounced = 0;
  for (const SolvedTouch& s : solved) {
    if (s.kind == SolvedTouch::Kind::bounces) bounced += 0.5 * s.impulse * s.impulse * s.normal;
  }
  if (bounced > 0 && before.energy_lost - out.energy_lost > kGain * bounced) {
    for (size_t k = solved.size(); k-- > 0;) take_back(solved[k]);
    out = before;
    sweep(solved, out);
  }
  std::erase_if(solved, [](const SolvedTouch& s) { return s.kind == SolvedTouch::Kind::near; });
  return static_cast<size_t>(std::count_if(solved.begin(), solved.end(),
                                           [](const SolvedTouch& s) { return s.push > 0 || s.impulse > 0; }));
}

}  // namespace truestep::contact
