#include "tests/bench/rigid3d/scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/collision/collision.h"
#include "engine/kernels/rigid/free_rotation.h"

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

/// Area of a centred cross-section, and the means of x^2 and z^2 over it.
struct Section {
  double area = 0, xx = 0, zz = 0;
};
Section section_of(const std::vector<std::array<double, 2>>& corners) {
  Section s;
  for (size_t i = 0; i < corners.size(); ++i) {
    const auto& [ax, az] = corners[i];
    const auto& [bx, bz] = corners[(i + 1) % corners.size()];
    const double twice = ax * bz - bx * az;
    s.area += twice / 2;
    s.xx += twice * (ax * ax + ax * bx + bx * bx) / 12, s.zz += twice * (az * az + az * bz + bz * bz) / 12;
  }
  s.xx /= s.area, s.zz /= s.area;
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

/// Mixed bodies, `across` by `across` per layer, that fall into a pit twice as many metres wide.
SpaceScene pile(int layers, int across) {
  SpaceScene s{.name = "pile", .bodies = {ground()}, .steps = 480};
  const double w = across;
  for (const double side : {1.0, -1.0})
    s.bodies.push_back(block({side * (w + 0.5), 0, 20}, {0.5, w + 1, 20}));
  for (const double side : {1.0, -1.0})
    s.bodies.push_back(block({0, side * (w + 0.5), 20}, {w + 1, 0.5, 20}));
  Dice dice;
  int count = 0;
  for (int k = 0; k < layers; ++k) {
    for (int i = 0; i < across; ++i) {
      for (int j = 0; j < across; ++j) {
        SpaceBody b{.shape = static_cast<Shape>(count++ % 3)};
        b.size = b.shape == Shape::box      ? Vec3{0.5, 0.4, 0.3}
                 : b.shape == Shape::sphere ? Vec3{0.45, 0, 0}
                                            : Vec3{0.3, 0.4, 0};
        const double middle = 0.5 * (across - 1), x = (i - middle) * 1.9 + (dice() - 0.5) * 0.2,
                     y = (j - middle) * 1.9 + (dice() - 0.5) * 0.2;
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

Quat about_y(double angle) {
  return {std::cos(angle / 2), 0, std::sin(angle / 2), 0};
}

/// A half circle of 15 stones, 1 m in radius and 0.2 m thick, between two fixed springers.
SpaceScene arch() {
  constexpr int kStones = 15;
  constexpr double kInner = 0.9, kOuter = 1.1, kHalf = std::numbers::pi / kStones / 2;
  SpaceScene s{.name = "arch", .bodies = {ground()}};
  // A stone is a trapezium: its inner and outer edges are chords.
  const double xi = kInner * std::cos(kHalf), xo = kOuter * std::cos(kHalf), zi = kInner * std::sin(kHalf),
               zo = kOuter * std::sin(kHalf);
  const double centre = xi + (xo - xi) * (zi + 2 * zo) / (3 * (zi + zo));
  const auto stone = [&](int k) {
    const double a = std::numbers::pi * (k + 0.5) / kStones;
    SpaceBody b{.shape = Shape::prism, .size = {0, 0.15, 0}};
    b.corners = {{xi - centre, -zi}, {xo - centre, -zo}, {xo - centre, zo}, {xi - centre, zi}};
    // Local x points outwards.
    b.pose = {{centre * std::cos(a), 0, 1 + centre * std::sin(a)}, about_y(-a)};
    b.fixed = k < 0 || k == kStones;
    s.bodies.push_back(b);
  };
  for (int k = -1; k <= kStones; ++k) stone(k);
  s.top = static_cast<size_t>(2 + kStones / 2);
  return s;
}

/// Cards of 1 m that lean by 20 degrees in pairs, in three storeys with flat cards between.
SpaceScene card_house() {
  constexpr double kHalf = 0.5, kThin = 0.02, kLean = std::numbers::pi / 9;
  constexpr int kStoreys = 3;
  SpaceScene s{.name = "house of cards", .bodies = {ground()}};
  const double across = kHalf * std::sin(kLean) + kThin * std::cos(kLean),
               up = kHalf * std::cos(kLean) + kThin * std::sin(kLean), spacing = 4 * across + 0.02;
  const auto card = [&](double x, double z, double angle, double half) {
    s.bodies.push_back({.size = {kThin, 0.3, half}, .pose = {{x, 0, z}, about_y(angle)}});
  };
  double z = 0;
  for (int storey = 0; storey < kStoreys; ++storey) {
    const int pairs = kStoreys - storey;
    for (int k = 0; k < pairs; ++k) {
      const double x = (k - 0.5 * (pairs - 1)) * spacing;
      card(x - across, z + up, kLean, kHalf), card(x + across, z + up, -kLean, kHalf);
    }
    z += 2 * up;
    for (int k = 0; k + 1 < pairs; ++k)
      card((k - 0.5 * (pairs - 2)) * spacing, z + kThin, std::numbers::pi / 2, 0.5 * spacing - 3e-3);
    z += 2 * kThin;
  }
  s.top = s.bodies.size() - 1;
  return s;
}

/// Rings of 16 bricks, each ring rotated by half a brick against the one below.
SpaceScene round_tower(int rings) {
  constexpr int kBricks = 16;
  constexpr double kRadius = 2;
  SpaceScene s{.name = "round tower", .bodies = {ground()}};
  for (int ring = 0; ring < rings; ++ring) {
    for (int k = 0; k < kBricks; ++k) {
      const double a = 2 * std::numbers::pi * (k + 0.5 * (ring % 2)) / kBricks;
      s.bodies.push_back({.size = {0.2, 0.34, 0.15},
                          .pose = {{kRadius * std::cos(a), kRadius * std::sin(a), 0.15 + 0.3 * ring},
                                   {std::cos(a / 2), 0, 0, std::sin(a / 2)}}});
    }
  }
  s.top = s.bodies.size() - 1;
  return s;
}

/// A small pile, ten seconds after it began to fall.
SpaceScene heap() {
  SpaceScene s = pile(12, 5);
  s.name = "heap", s.settle = 600;
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
  // As few substeps as lose no more than Rapier does.
  SpaceScene fewer = pyramid(15);
  fewer.name = "pyramid in 4 substeps", fewer.substeps = 4;
  return {pyramid(15),          pile(20, 10),         wall(40), joint_grid(45),
          space_stack(10, 600), space_stack(20, 600), top(),    fewer};
}

std::vector<SpaceScene> standing_space_scenes() {
  std::vector<SpaceScene> all{wall(40),           pyramid(15),        space_stack(10, 0),
                              space_stack(20, 0), space_stack(50, 0), arch(),
                              card_house(),       round_tower(20),    heap()};
  for (SpaceScene& s : all) {
    if (s.top == 0 && s.settle == 0) s.top = s.bodies.size() - 1;
  }
  return all;
}

Solid solid(const SpaceBody& b) {
  return b.shape == Shape::box      ? box_solid(b.size)
         : b.shape == Shape::sphere ? sphere_solid(b.size.x)
                                    : capsule_solid(b.size.x, b.size.y);
}

std::vector<Vec3> prism_points(const SpaceBody& b) {
  std::vector<Vec3> points;
  for (const auto& [x, z] : b.corners)
    points.push_back({x, -b.size.y, z}), points.push_back({x, b.size.y, z});
  return points;
}

double mass(const SpaceBody& b) {
  if (b.shape == Shape::prism) return kSpaceDensity * 2 * b.size.y * section_of(b.corners).area;
  return mass_properties(solid(b), kSpaceDensity).mass;
}

Vec3 moments(const SpaceBody& b) {
  if (b.shape == Shape::prism) {
    const Section s = section_of(b.corners);
    const double m = mass(b), along = b.size.y * b.size.y / 3;
    return {m * (s.zz + along), m * (s.xx + s.zz), m * (s.xx + along)};
  }
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
