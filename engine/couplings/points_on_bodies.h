// Impulses between points and bodies, where points may respond together with everything tied to them
// (core/equations/impulse_answer.h) and bodies by their mass and inertia. A link joins a blend of points, q =
// sum b_i x_i, to a place on a body; u = q' less the velocity of that place, J the impulse on the points, -J
// on the body there (at q, or at a given place when the link has a length), W J the change of u by all
// impulses:
//   J = S y,  (give + S W S) y = right,   S = along n n^T + across (1 - n n^T) for every link,
// symmetric positive semidefinite, solved by conjugate gradients (Saad 2003, algorithm 6.18) with one solve
// of the points' equations per iteration.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "engine/core/coupling.h"
#include "engine/core/equations/impulse_answer.h"
#include "engine/math/quaternion.h"

namespace truestep {

/// Points and a body, as seen by an impulse between them.
struct BodyLink {
  std::array<uint32_t, 3> rows{};
  std::array<double, 3> weights{1, 0, 0};
  uint32_t count = 1, body = 0;
  enum class Body : uint8_t { moves, stays } answers = Body::moves;  ///< stays: it sleeps
  std::optional<Vec3> held{};  ///< m, in the body's frame: where it is held, if not where the points are

  Vec3 blend(auto&& of_row) const {
    Vec3 sum;
    for (uint32_t i = 0; i < count; ++i) sum += of_row(rows[i]) * weights[i];
    return sum;
  }
  Vec3 place(const auto& points) const {
    return blend([&](size_t i) { return points.place(i); });
  }
  /// m, from the body's centre of mass to where it is pushed.
  Vec3 arm(const auto& points, const auto& bodies) const {
    return held ? rotation(bodies.orientation(body)).apply(*held) : place(points) - bodies.place(body);
  }
  /// m/s, velocity of the points relative to the body where it is pushed.
  Vec3 relative(const auto& points, const auto& bodies) const {
    return blend([&](size_t i) { return points.velocity(i); }) -
           bodies.velocity_at(body, arm(points, bodies));
  }
  /// 1/kg, of the points alone.
  double inverse_mass(const auto& points) const {
    double k = 0;
    for (uint32_t i = 0; i < count; ++i) k += weights[i] * weights[i] * points.inverse_mass(rows[i]);
    return k;
  }
  /// Impulse (N s) on the points and the opposite on the body.
  void push(Points& points, Bodies& bodies, const Vec3& j) const {
    if (answers == Body::moves) bodies.push(body, arm(points, bodies), -j);
    for (uint32_t i = 0; i < count; ++i) {
      points.accelerate(rows[i], j * (weights[i] * points.inverse_mass(rows[i])));
    }
  }
  /// Position correction (kg m) likewise; angular momentum is conserved.
  void shift(Points& points, Bodies& bodies, const Vec3& p) const {
    if (answers == Body::moves) bodies.shift(body, arm(points, bodies), -p, gained(points, bodies, p));
    for (uint32_t i = 0; i < count; ++i) {
      points.shift(rows[i], p * (weights[i] * points.inverse_mass(rows[i])));
    }
  }
  /// Angular momentum (kg m^2/s) that a correction adds to the pair.
  Vec3 gained(const Points& points, const Bodies& bodies, const Vec3& p) const {
    Vec3 v = -bodies.velocity(body);
    for (uint32_t i = 0; i < count; ++i) {
      if (points.inverse_mass(rows[i]) > 0) v += points.velocity(rows[i]) * weights[i];
    }
    return cross(p, v);
  }
};

struct AnsweredLink {
  BodyLink link;
  Vec3 n = {};  ///< unit vector, if along and across differ
  double along = 1, across = 1, give = 0;
  Vec3 right = {};    ///< the right-hand side
  Vec3 impulse = {};  ///< N s on the points, out
  Vec3 change = {};   ///< m/s, change of u by all impulses, out
};

class PointsOnBodies {
 public:
  PointsOnBodies(const System& points, PointPort point_columns, BodyPort body_columns)
      : together_(answers_together(points)), points_(point_columns), bodies_(body_columns) {}

  /// Whether the points respond as a whole.
  bool together() const { return together_ != nullptr; }
  AnswersImpulses::Seconds answer_seconds() const {
    return together_ ? together_->answer_seconds() : AnswersImpulses::Seconds{};
  }
  const PointPort& points() const { return points_; }
  const BodyPort& bodies() const { return bodies_; }

  /// Solves for the impulses and their effects; nothing moves. Stops at the relative residual `accuracy` or
  /// after `most` iterations.
  void solve(State& points, State& bodies, const StepInput& in, std::vector<AnsweredLink>& links,
             double accuracy, size_t most) const;
  /// Moves both sides by the links' impulses: velocities by dv, positions by h dv. Call after solve.
  void move(State& points, State& bodies, const StepInput& in, std::vector<AnsweredLink>& links) const;

 private:
  struct Work;
  template <class ImpulseOf>
  void respond(Work& work, const StepInput& in, AnswersImpulses::Answer which,
               const std::vector<AnsweredLink>& links, ImpulseOf impulse_of) const;

  const AnswersImpulses* together_;  // null: each point responds for itself
  PointPort points_;
  BodyPort bodies_;
};

}  // namespace truestep
