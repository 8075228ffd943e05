#include "engine/couplings/points_on_bodies.h"

#include <algorithm>
#include <cmath>

#include "engine/couplings/conjugate_gradients.h"

namespace truestep {

namespace {

Vec3 shape(const AnsweredLink& l, const Vec3& y) {
  return y * l.across + l.n * ((l.along - l.across) * dot(l.n, y));
}

/// The effect of impulses on a body.
struct BodyChange {
  BodyImpulse on;
  Vec3 gained;
};

}  // namespace

/// Both sides, with impulses on them and their effects.
struct PointsOnBodies::Work {
  Work(const PointsOnBodies& p, State& points_state, State& bodies_state, Workspace& whole)
      : points_state(points_state),
        points(points_state, p.points_),
        bodies(bodies_state, p.bodies_, &whole),
        memory(whole.object<Workspace>("links")),
        impulse(memory.doubles("links.impulse", 3 * points.count)),
        dv(memory.doubles("links.dv", 3 * points.count)),
        on_bodies(memory.object<std::vector<BodyChange>>("links.bodies")),
        answers(memory.object<std::vector<BodyTwist>>("links.answers")) {
    std::fill(impulse.begin(), impulse.end(), 0.0);
    std::fill(dv.begin(), dv.end(), 0.0);
    on_bodies.assign(bodies.count(), {});
    if (!bodies.free()) answers.assign(bodies.count(), {});
  }
  Vec3 change(const AnsweredLink& l) const {
    const uint32_t b = l.link.body;
    const Vec3 arm = l.link.arm(points, bodies);
    const BodyForm& f = bodies.form(b);
    const Vec3 u = l.link.blend([&](size_t i) { return load3(dv.data(), i); });
    if (!bodies.free()) return u - answers[b].velocity - cross(answers[b].spin, arm);
    if (!(f.mass > 0)) return u;
    const Vec3 dw = free_rotation::spin_of(bodies.orientation(b), on_bodies[b].on.twist, f.moments);
    return u - on_bodies[b].on.impulse / f.mass - cross(dw, arm);
  }

  State& points_state;
  Points points;
  Bodies bodies;
  Workspace& memory;
  std::span<double> impulse, dv;
  std::vector<BodyChange>& on_bodies;
  std::vector<BodyTwist>& answers;  ///< for bodies that respond together
};

template <class ImpulseOf>
void PointsOnBodies::respond(Work& work, const StepInput& in, AnswersImpulses::Answer which,
                             const std::vector<AnsweredLink>& links, ImpulseOf impulse_of) const {
  const auto each_row = [&](const AnsweredLink& l, auto&& body) {
    for (uint32_t i = 0; i < l.link.count; ++i) body(l.link.rows[i], l.link.weights[i]);
  };
  for (const AnsweredLink& l : links) {
    each_row(l, [&](uint32_t row, double) { store3(work.impulse.data(), row, Vec3{}); });
    work.on_bodies[l.link.body] = {};
  }
  for (size_t k = 0; k < links.size(); ++k) {
    const AnsweredLink& l = links[k];
    const Vec3 j = impulse_of(k);
    each_row(l, [&](uint32_t row, double b) {
      store3(work.impulse.data(), row, load3(work.impulse.data(), row) + j * b);
    });
    BodyChange& body = work.on_bodies[l.link.body];
    body.on.impulse -= j, body.on.twist -= cross(l.link.arm(work.points, work.bodies), j);
  }
  if (!work.bodies.free()) {
    auto& on = work.memory.object<std::vector<BodyImpulse>>("links.on_bodies");
    on.resize(work.on_bodies.size());
    for (size_t b = 0; b < on.size(); ++b) on[b] = work.on_bodies[b].on;
    work.bodies.answers(on, work.answers);
  }
  if (together_) {
    const StepInput own{in.t, in.h, in.step, work.memory, in.arena, nullptr};
    return together_->answer(work.points_state, own, which, work.impulse, work.dv);
  }
  for (const AnsweredLink& l : links) {
    each_row(l, [&](uint32_t row, double) {
      store3(work.dv.data(), row, load3(work.impulse.data(), row) * work.points.inverse_mass(row));
    });
  }
}

void PointsOnBodies::solve(State& points, State& bodies, const StepInput& in,
                           std::vector<AnsweredLink>& links, double accuracy, size_t most) const {
  Work work(*this, points, bodies, in.workspace);
  const size_t n = links.size();
  // Builds the matrix, which the following calls reuse.
  respond(work, in, AnswersImpulses::Answer::first, links, [](size_t) { return Vec3{}; });
  const auto y = conjugate_gradients(
      n, in.workspace.object<Workspace>("links.solve"), {accuracy, most},
      [&](size_t k) { return links[k].right; },
      [&](std::span<const double> d) {
        respond(work, in, AnswersImpulses::Answer::again, links,
                [&](size_t k) { return shape(links[k], load3(d.data(), k)); });
      },
      [&](size_t k, const Vec3& d) { return d * links[k].give + shape(links[k], work.change(links[k])); });
  for (size_t k = 0; k < n; ++k) links[k].impulse = shape(links[k], load3(y.data(), k));
}

void PointsOnBodies::move(State& points, State& bodies, const StepInput& in,
                          std::vector<AnsweredLink>& links) const {
  if (links.empty()) return;
  Work work(*this, points, bodies, in.workspace);
  auto& arms = work.memory.object<std::vector<Vec3>>("links.arms");
  arms.clear();
  for (const AnsweredLink& l : links) arms.push_back(l.link.arm(work.points, work.bodies));
  respond(work, in, AnswersImpulses::Answer::again, links, [&](size_t k) { return links[k].impulse; });
  for (AnsweredLink& l : links) l.change = work.change(l);
  const auto move_point = [&](size_t row) {
    const Vec3 d = load3(work.dv.data(), row);
    work.points.accelerate(row, d);
    work.points.shift(row, d * in.h);
    store3(work.dv.data(), row, Vec3{});
  };
  // Velocities of the bodies first: the gain of their position corrections depends on them.
  for (uint32_t b = 0; b < work.on_bodies.size(); ++b) {
    const BodyChange& c = work.on_bodies[b];
    if (!c.on.none()) work.bodies.push_and_turn(b, c.on.impulse, c.on.twist);
  }
  if (together_) {
    for (size_t i = 0; i < work.points.count; ++i) move_point(i);
  } else {
    for (const AnsweredLink& l : links) {
      for (uint32_t i = 0; i < l.link.count; ++i) move_point(l.link.rows[i]);
    }
  }
  if (!work.bodies.free()) {
    // One after the other: each changes the velocities on which the next one's gain depends.
    for (size_t k = 0; k < links.size(); ++k) {
      const BodyLink& l = links[k].link;
      const Vec3 p = links[k].impulse * in.h;
      work.bodies.shift(l.body, arms[k], -p, together_ ? Vec3{} : l.gained(work.points, work.bodies, p));
    }
    return;
  }
  if (!together_) {
    for (const AnsweredLink& l : links) {
      work.on_bodies[l.link.body].gained += l.link.gained(work.points, work.bodies, l.impulse * in.h);
    }
  }
  for (uint32_t b = 0; b < work.on_bodies.size(); ++b) {
    const BodyChange& c = work.on_bodies[b];
    const BodyForm& f = work.bodies.form(b);
    if (!(f.mass > 0) || c.on.none()) continue;
    const Vec3 turn = free_rotation::spin_of(work.bodies.orientation(b), c.on.twist, f.moments);
    work.bodies.move(b, c.on.impulse * (in.h / f.mass), turn * in.h, c.gained);
  }
}

}  // namespace truestep
