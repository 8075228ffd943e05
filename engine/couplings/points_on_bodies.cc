#include "engine/couplings/points_on_bodies.h"

#include <algorithm>
#include <cmath>

#include "engine/couplings/conjugate_gradients.h"

namespace truestep {

namespace {

Vec3 shape(const AnsweredLink& l, const Vec3& y) {
  return y * l.across + l.n * ((l.along - l.across) * dot(l.n, y));
}

/// What impulses do to a body.
struct BodyChange {
  Vec3 impulse, twist, gained;
};

}  // namespace

/// Both sides, with impulses on them and what these change.
struct PointsOnBodies::Work {
  Work(const PointsOnBodies& p, State& points_state, State& bodies_state, Workspace& memory)
      : points_state(points_state),
        points(points_state, p.points_),
        bodies(bodies_state, p.bodies_),
        memory(memory),
        impulse(memory.doubles("links.impulse", 3 * points.count)),
        dv(memory.doubles("links.dv", 3 * points.count)),
        on_bodies(memory.object<std::vector<BodyChange>>("links.bodies")) {
    std::fill(impulse.begin(), impulse.end(), 0.0);
    std::fill(dv.begin(), dv.end(), 0.0);
    on_bodies.assign(bodies.count(), {});
  }
  Vec3 change(const AnsweredLink& l) const {
    const uint32_t b = l.link.body;
    const Vec3 arm = l.link.arm(points, bodies);
    const BodyForm& f = bodies.form(b);
    const Vec3 u = l.link.blend([&](size_t i) { return load3(dv.data(), i); });
    if (!(f.mass > 0)) return u;
    const Vec3 dw = free_rotation::spin_of(bodies.orientation(b), on_bodies[b].twist, f.moments);
    return u - on_bodies[b].impulse / f.mass - cross(dw, arm);
  }

  State& points_state;
  Points points;
  Bodies bodies;
  Workspace& memory;
  std::span<double> impulse, dv;
  std::vector<BodyChange>& on_bodies;
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
    body.impulse -= j, body.twist -= cross(l.link.arm(work.points, work.bodies), j);
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
  Work work(*this, points, bodies, in.workspace.object<Workspace>("links"));
  const size_t n = links.size();
  // The matrix, which what follows goes on with.
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
  Work work(*this, points, bodies, in.workspace.object<Workspace>("links"));
  respond(work, in, AnswersImpulses::Answer::again, links, [&](size_t k) { return links[k].impulse; });
  for (AnsweredLink& l : links) l.change = work.change(l);
  const auto move_point = [&](size_t row) {
    const Vec3 d = load3(work.dv.data(), row);
    work.points.accelerate(row, d);
    work.points.shift(row, d * in.h);
    store3(work.dv.data(), row, Vec3{});
  };
  // Velocities of the bodies first: what their corrections of place gain depends on them.
  for (uint32_t b = 0; b < work.on_bodies.size(); ++b) {
    const BodyChange& c = work.on_bodies[b];
    if (norm2(c.impulse) + norm2(c.twist) > 0) work.bodies.push_and_turn(b, c.impulse, c.twist);
  }
  if (together_) {
    for (size_t i = 0; i < work.points.count; ++i) move_point(i);
  } else {
    for (const AnsweredLink& l : links) {
      for (uint32_t i = 0; i < l.link.count; ++i) move_point(l.link.rows[i]);
    }
    for (const AnsweredLink& l : links) {
      work.on_bodies[l.link.body].gained += l.link.gained(work.points, work.bodies, l.impulse * in.h);
    }
  }
  for (uint32_t b = 0; b < work.on_bodies.size(); ++b) {
    const BodyChange& c = work.on_bodies[b];
    const BodyForm& f = work.bodies.form(b);
    if (!(f.mass > 0) || !(norm2(c.impulse) + norm2(c.twist) > 0)) continue;
    const Vec3 turn = free_rotation::spin_of(work.bodies.orientation(b), c.twist, f.moments);
    work.bodies.move(b, c.impulse * (in.h / f.mass), turn * in.h, c.gained);
  }
}

}  // namespace truestep
