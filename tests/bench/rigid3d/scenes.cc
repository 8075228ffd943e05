#include "tests/bench/rigid3d/scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/collision/collision.h"
#include "engine/kernels/free_rotation.h"

namespace truestep::bench {
namespace {

using Shape = SpaceBody::Shape;

SpaceBody box(const Vec3& at) {
  return {.pose = {at, {}}};
}
SpaceBody block(const Vec3& at, const Vec3& half) {
  return {.size = half, .pose = {at, {}}, .fixed = true};
}
SpaceBody ground() {
  return block({0, 0, -1}, {100, 100, 1});
}

SpaceScene pyramid(int n) {
  SpaceScene s{.name = "pyramid", .bodies = {ground()}, .steps = 300};
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < n - k; ++i) {
      for (int j = 0; j < n - k; ++j) {
        const double middle = (n - k - 1) * 0.5;
        s.bodies.push_back(box({(i - middle) * 1.05, (j - middle) * 1.05, 0.5 + k}));
      }
    }
  }
  return s;
}

SpaceScene wall(int n) {
  SpaceScene s{.name = "wall", .bodies = {ground()}, .steps = 300};
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < n - k; ++i) s.bodies.push_back(box({(i - (n - k - 1) * 0.5) * 1.01, 0, 0.5 + k}));
  }
  return s;
}

/// Numbers in [0, 1) by a linear congruence, alike for every engine.
struct Dice {
  uint32_t state = 12345;
  double operator()() {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) * (1.0 / 16777216.0);
  }
};

/// Mixed bodies that fall into a pit of 20 x 20 m.
SpaceScene pile(int layers) {
  SpaceScene s{.name = "pile", .bodies = {ground()}, .steps = 480};
  constexpr double w = 10;
  for (const double side : {1.0, -1.0})
    s.bodies.push_back(block({side * (w + 0.5), 0, 20}, {0.5, w + 1, 20}));
  for (const double side : {1.0, -1.0})
    s.bodies.push_back(block({0, side * (w + 0.5), 20}, {w + 1, 0.5, 20}));
  Dice dice;
  int count = 0;
  for (int k = 0; k < layers; ++k) {
    for (int i = 0; i < 10; ++i) {
      for (int j = 0; j < 10; ++j) {
        SpaceBody b{.shape = static_cast<Shape>(count++ % 3)};
        b.size = b.shape == Shape::box      ? Vec3{0.5, 0.4, 0.3}
                 : b.shape == Shape::sphere ? Vec3{0.45, 0, 0}
                                            : Vec3{0.3, 0.4, 0};
        const double x = (i - 4.5) * 1.9 + (dice() - 0.5) * 0.2, y = (j - 4.5) * 1.9 + (dice() - 0.5) * 0.2;
        const double half = dice() * std::numbers::pi, ax = dice() - 0.5, ay = dice() - 0.5,
                     az = dice() - 0.5;
        const Vec3 axis = normalized(Vec3{ax, ay, az}) * std::sin(half);
        b.pose = {{x, y, 1.5 + k * 1.6}, {std::cos(half), axis.x, axis.y, axis.z}};
        if (b.shape == Shape::capsule) {
          b.pose.orientation = b.pose.orientation * Quat{std::sqrt(0.5), std::sqrt(0.5), 0, 0};
        }
        s.bodies.push_back(b);
      }
    }
  }
  return s;
}

SpaceScene joint_grid(int n) {
  SpaceScene s{.name = "joint grid", .collide = false, .steps = 300};
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < n; ++i) {
      const int id = static_cast<int>(s.bodies.size());
      const double x = k, z = -i;
      s.bodies.push_back({.shape = Shape::sphere, .size = {0.4, 0, 0}, .pose = {{x, 0, z}, {}}});
      s.bodies.back().fixed = i == 0 && std::abs(k - n / 2) <= 3;
      if (i > 0) s.joints.push_back({id - 1, id, {x, 0, z + 0.5}});
      if (k > 0) s.joints.push_back({id - n, id, {x - 0.5, 0, z}});
    }
  }
  return s;
}

SpaceScene top() {
  SpaceScene s{.name = "free top", .gravity = {}, .collide = false};
  s.bodies.push_back({.size = {1.5, 1, 0.5}, .angular_velocity = {1, 2, 3}});
  return s;
}

}  // namespace

SpaceScene space_stack(int boxes, int steps) {
  SpaceScene s{.name = "stack of " + std::to_string(boxes), .bodies = {ground()}, .steps = steps};
  for (int i = 0; i < boxes; ++i) s.bodies.push_back(box({0, 0, 0.5 + i}));
  return s;
}

std::vector<SpaceScene> space_scenes() {
  // As few small steps as lose no more than Rapier does.
  SpaceScene fewer = pyramid(15);
  fewer.name = "pyramid in 4 small steps", fewer.substeps = 4;
  return {pyramid(15),          pile(20), wall(40), joint_grid(45), space_stack(10, 600),
          space_stack(20, 600), top(),    fewer};
}

Solid solid(const SpaceBody& b) {
  return b.shape == Shape::box      ? box_solid(b.size)
         : b.shape == Shape::sphere ? sphere_solid(b.size.x)
                                    : capsule_solid(b.size.x, b.size.y);
}

double mass(const SpaceBody& b) {
  return mass_properties(solid(b), kSpaceDensity).mass;
}

Vec3 moments(const SpaceBody& b) {
  const Symmetric3 I = mass_properties(solid(b), kSpaceDensity).inertia;
  return {I.xx, I.yy, I.zz};
}

SpaceEnergy energy(const SpaceScene& scene, const std::vector<SpaceState>& state) {
  SpaceEnergy e;
  for (size_t i = 0; i < state.size(); ++i) {
    if (scene.bodies[i].fixed) continue;
    const double m = mass(scene.bodies[i]);
    const Vec3 own = rotation(state[i].pose.orientation).apply_inverse(state[i].angular_velocity);
    e.kinetic += 0.5 * m * norm2(state[i].velocity) +
                 0.5 * dot(own, free_rotation::times(moments(scene.bodies[i]), own));
    e.potential -= m * dot(scene.gravity, state[i].pose.position);
  }
  return e;
}

double deepest(const SpaceScene& scene, const std::vector<SpaceState>& state) {
  std::vector<Solid> solids;
  std::vector<Transform> at;
  std::vector<Box> boxes;
  std::vector<Mobility> mobility;
  for (size_t i = 0; i < state.size(); ++i) {
    solids.push_back(solid(scene.bodies[i]));
    at.push_back(transform_of(state[i].pose));
    boxes.push_back(bounds(solids[i], at[i]));
    mobility.push_back(scene.bodies[i].fixed ? Mobility::fixed : Mobility::moving);
  }
  BroadPhase broad;
  double most = 0;
  for (const BodyPair& p : broad.update(boxes, mobility, 0)) {
    Manifold m;
    if (collide(solids[p.a], at[p.a], solids[p.b], at[p.b], 0, m)) most = std::max(most, m.deepest());
  }
  return most;
}

double widest(const SpaceScene& scene, const std::vector<SpaceState>& state) {
  double most = 0;
  for (const SpaceJoint& j : scene.joints) {
    const auto anchor = [&](int i) {
      const auto k = static_cast<size_t>(i);
      const Pose& now = state[k].pose;
      return now.position + rotation(now.orientation).apply(j.anchor - scene.bodies[k].pose.position);
    };
    most = std::max(most, norm(anchor(j.a) - anchor(j.b)));
  }
  return most;
}

double turn_error(const SpaceBody& start, const SpaceState& now, double t) {
  constexpr int kParts = 100'000;
  free_rotation::Motion m{start.pose.orientation, start.angular_velocity};
  const Vec3 I = moments(start);
  for (int k = 0; k < kParts; ++k) m = free_rotation::advance(m, I, t / kParts);
  const Quat q = m.orientation;
  return norm(free_rotation::rotation_vector(Quat{q.w, -q.x, -q.y, -q.z} * now.pose.orientation));
}

}  // namespace truestep::bench
