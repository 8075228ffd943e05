#include "tests/bench/rigid2d/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace truestep::bench {
namespace {

using Kind = FlatBody::Kind;

FlatScene large_pyramid() {
  FlatScene s{.name = "large pyramid"};
  s.bodies.push_back({Kind::fixed, 0, -1, 0, {{100, 1}}});
  for (int i = 0; i < 100; ++i) {
    for (int j = i; j < 100; ++j)
      s.bodies.push_back({Kind::dynamic, (i + 1) * 0.5 + (j - i) - 50.0, i + 0.5, 0, {{0.5, 0.5}}});
  }
  return s;
}

FlatScene many_pyramids() {
  FlatScene s{.name = "many pyramids", .steps = 100};
  FlatBody ground{.kind = Kind::fixed};
  for (int r = 0; r < 20; ++r) ground.shapes.push_back({110, 0, 0, 11.0 * r});
  s.bodies.push_back(ground);
  for (int r = 0; r < 20; ++r) {
    for (int c = 0; c < 20; ++c) {
      for (int i = 0; i < 10; ++i) {
        for (int j = i; j < 10; ++j) {
          s.bodies.push_back({Kind::dynamic,
                              (i + 1) * 0.5 + (j - i) - 109.5 + 11.0 * c,
                              i + 0.5 + 11.0 * r,
                              0,
                              {{0.5, 0.5}}});
        }
      }
    }
  }
  return s;
}

FlatScene joint_grid() {
  FlatScene s{.name = "joint grid", .collide = false};
  for (int k = 0; k < 100; ++k) {
    for (int i = 0; i < 100; ++i) {
      const bool held = k >= 47 && k <= 53 && i == 0;
      const auto id = static_cast<int>(s.bodies.size());
      s.bodies.push_back({held ? Kind::fixed : Kind::dynamic, 1.0 * k, -1.0 * i, 0, {{0, 0.4}}});
      if (i > 0) s.joints.push_back({id - 1, id, 0, -0.5, 0, 0.5});
      if (k > 0) s.joints.push_back({id - 100, id, 0.5, 0, -0.5, 0});
    }
  }
  return s;
}

FlatScene smash() {
  FlatScene s{.name = "smash", .gravity = 0};
  // Whatever touches it may sleep as well.
  s.bodies.push_back({Kind::sleeper, -20, 0, 40, {{4, 4, 0, 0, 8}}});
  for (int i = 0; i < 120; ++i) {
    for (int j = 0; j < 80; ++j)
      s.bodies.push_back({Kind::asleep, i * 0.4 + 30, (j - 40) * 0.4, 0, {{0.2, 0.2}}});
  }
  return s;
}

FlatScene tumbler() {
  FlatScene s{.name = "tumbler", .steps = 400};
  s.bodies.push_back({Kind::fixed});
  s.bodies.push_back(
      {Kind::dynamic,
       0,
       10,
       0,
       {{0.5, 10, 10, 0, 50}, {0.5, 10, -10, 0, 50}, {10, 0.5, 0, 10, 50}, {10, 0.5, 0, -10, 50}}});
  s.joints.push_back({0, 1, 0, 10, 0, 0, std::numbers::pi / 180 * 25, 1e8});
  for (int i = 0; i < 45; ++i) {
    for (int j = 0; j < 45; ++j)
      s.bodies.push_back({Kind::dynamic, -9 + 0.4 * j, 1 + 0.4 * i, 0, {{0.125, 0.125}}});
  }
  return s;
}

constexpr double kDown = 10;

/// A half circle of 15 stones, 10 m in radius and 2 m thick, between two fixed springers.
FlatScene arch() {
  constexpr int kStones = 15;
  constexpr double kInner = 9, kOuter = 11, kHalf = std::numbers::pi / kStones / 2;
  FlatScene s{.name = "arch"};
  s.bodies.push_back({Kind::fixed, 0, -1, 0, {{100, 1}}});
  const double xi = kInner * std::cos(kHalf), xo = kOuter * std::cos(kHalf), yi = kInner * std::sin(kHalf),
               yo = kOuter * std::sin(kHalf);
  const double centre = xi + (xo - xi) * (yi + 2 * yo) / (3 * (yi + yo));
  FlatShape stone{xo - centre, yo};
  stone.corners = {{xi - centre, -yi}, {xo - centre, -yo}, {xo - centre, yo}, {xi - centre, yi}};
  for (int k = -1; k <= kStones; ++k) {
    const double a = std::numbers::pi * (k + 0.5) / kStones;
    FlatBody b{k < 0 || k == kStones ? Kind::fixed : Kind::dynamic,
               centre * std::cos(a),
               kDown + centre * std::sin(a),
               0,
               {stone}};
    b.angle = a;
    s.bodies.push_back(b);
  }
  s.top = 2 + kStones / 2;
  return s;
}

/// Cards of 4 m that lean by 20 degrees in pairs, in three storeys with flat cards between.
FlatScene card_house() {
  constexpr double kHalf = 2, kThin = 0.08, kLean = std::numbers::pi / 9;
  constexpr int kStoreys = 3;
  FlatScene s{.name = "house of cards"};
  s.bodies.push_back({Kind::fixed, 0, -1, 0, {{100, 1}}});
  const double across = kHalf * std::sin(kLean) + kThin * std::cos(kLean),
               up = kHalf * std::cos(kLean) + kThin * std::sin(kLean), spacing = 4 * across + 0.08;
  const auto card = [&](double x, double y, double angle, double half) {
    FlatBody b{Kind::dynamic, x, y, 0, {{kThin, half}}};
    b.angle = angle;
    s.bodies.push_back(b);
  };
  double y = 0;
  for (int storey = 0; storey < kStoreys; ++storey) {
    const int pairs = kStoreys - storey;
    for (int k = 0; k < pairs; ++k) {
      const double x = (k - 0.5 * (pairs - 1)) * spacing;
      card(x - across, y + up, -kLean, kHalf), card(x + across, y + up, kLean, kHalf);
    }
    y += 2 * up;
    for (int k = 0; k + 1 < pairs; ++k)
      card((k - 0.5 * (pairs - 2)) * spacing, y + kThin, std::numbers::pi / 2, 0.5 * spacing - 0.012);
    y += 2 * kThin;
  }
  s.top = s.bodies.size() - 1;
  return s;
}

/// Boxes and disks that fell between two walls ten seconds ago.
FlatScene heap() {
  FlatScene s{.name = "heap", .settle = 600};
  s.bodies.push_back({Kind::fixed, 0, 20, 0, {{12, 1, 0, -21}, {1, 20, -11, 0}, {1, 20, 11, 0}}});
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 15; ++j) {
      FlatBody b{Kind::dynamic, -9.1 + 1.3 * j + 0.05 * (i % 3), 1 + 1.3 * i, 0, {}};
      if ((i + j) % 3 == 0) {
        b.shapes = {{0, 0.4 + 0.02 * (i % 5)}};
      } else {
        b.shapes = {{0.3 + 0.02 * (j % 8), 0.4}};
      }
      b.angle = 0.37 * i + 0.61 * j;
      s.bodies.push_back(b);
    }
  }
  return s;
}

struct Corner {
  double x, y;
};
struct Placed {
  std::array<Corner, 4> corner;
  double left, right, low, high;
  size_t body;
};

Placed place(const FlatShape& h, const FlatPose& p, size_t body) {
  Placed r{{}, HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL, body};
  const double c = std::cos(p.angle), s = std::sin(p.angle);
  // A segment is the top of a slab.
  const double low = h.hy > 0 ? -h.hy : -1, high = h.hy;
  Corner local[4] = {{-h.hx, low}, {h.hx, low}, {h.hx, high}, {-h.hx, high}};
  for (size_t i = 0; i < h.corners.size(); ++i) local[i] = {h.corners[i][0], h.corners[i][1]};
  for (size_t i = 0; i < 4; ++i) {
    const double x = h.cx + local[i].x, y = h.cy + local[i].y;
    r.corner[i] = {p.x + c * x - s * y, p.y + s * x + c * y};
    r.left = std::min(r.left, r.corner[i].x), r.right = std::max(r.right, r.corner[i].x);
    r.low = std::min(r.low, r.corner[i].y), r.high = std::max(r.high, r.corner[i].y);
  }
  return r;
}

/// Smallest overlap over the normals of both; 0 if an axis separates them.
double overlap(const Placed& a, const Placed& b) {
  double least = HUGE_VAL;
  for (const Placed* p : {&a, &b}) {
    for (size_t i = 0; i < 4; ++i) {
      const Corner &from = p->corner[i], &to = p->corner[(i + 1) % 4];
      const double ex = to.x - from.x, ey = to.y - from.y;
      const double l = std::hypot(ex, ey), nx = ey / l, ny = -ex / l;
      double a0 = HUGE_VAL, a1 = -HUGE_VAL, b0 = HUGE_VAL, b1 = -HUGE_VAL;
      for (size_t k = 0; k < 4; ++k) {
        const double u = nx * a.corner[k].x + ny * a.corner[k].y, v = nx * b.corner[k].x + ny * b.corner[k].y;
        a0 = std::min(a0, u), a1 = std::max(a1, u), b0 = std::min(b0, v), b1 = std::max(b1, v);
      }
      least = std::min({least, a1 - b0, b1 - a0});
      if (least <= 0) return 0;
    }
  }
  return least;
}

double deepest(const FlatScene& scene, const std::vector<FlatPose>& poses) {
  std::vector<Placed> all;
  for (size_t i = 0; i < scene.bodies.size(); ++i) {
    for (const FlatShape& h : scene.bodies[i].shapes) all.push_back(place(h, poses[i], i));
  }
  // Swept from bottom to top: the rows of pyramids keep the list of open boxes short, whereas wide grounds
  // stay in it.
  std::sort(all.begin(), all.end(), [](const Placed& a, const Placed& b) { return a.left < b.left; });
  std::vector<size_t> open;
  double most = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    std::erase_if(open, [&](size_t k) { return all[k].right < all[i].left; });
    for (const size_t k : open) {
      const bool fixed =
          scene.bodies[all[k].body].kind == Kind::fixed && scene.bodies[all[i].body].kind == Kind::fixed;
      if (fixed || all[k].body == all[i].body || all[k].high < all[i].low || all[i].high < all[k].low)
        continue;
      most = std::max(most, overlap(all[k], all[i]));
    }
    open.push_back(i);
  }
  return most;
}

}  // namespace

std::vector<FlatScene> flat_scenes() {
  return {large_pyramid(), many_pyramids(), joint_grid(), smash(), tumbler()};
}

FlatScene flat_stack(int boxes) {
  FlatScene s{.name = "stack of " + std::to_string(boxes)};
  s.bodies.push_back({Kind::fixed, 0, -1, 0, {{100, 1}}});
  for (int i = 0; i < boxes; ++i) s.bodies.push_back({Kind::dynamic, 0, i + 0.5, 0, {{0.5, 0.5}}});
  s.top = s.bodies.size() - 1;
  return s;
}

std::vector<FlatScene> standing_flat_scenes() {
  FlatScene pyramid = large_pyramid();
  pyramid.top = pyramid.bodies.size() - 1;
  return {pyramid, flat_stack(10), flat_stack(20), flat_stack(50), arch(), card_house(), heap()};
}

FlatMass flat_mass(const FlatBody& body) {
  FlatMass all;
  for (const FlatShape& h : body.shapes) {
    double area = 4 * h.hx * h.hy, polar = (h.hx * h.hx + h.hy * h.hy) / 3;
    if (h.hx == 0) area = std::numbers::pi * h.hy * h.hy, polar = h.hy * h.hy / 2;
    if (!h.corners.empty()) {
      area = polar = 0;
      for (size_t i = 0; i < h.corners.size(); ++i) {
        const auto& [ax, ay] = h.corners[i];
        const auto& [bx, by] = h.corners[(i + 1) % h.corners.size()];
        const double twice = ax * by - bx * ay;
        area += twice / 2;
        polar += twice * (ax * ax + ax * bx + bx * bx + ay * ay + ay * by + by * by) / 12;
      }
      polar /= area;
    }
    all.mass += h.density * area;
    all.inertia += h.density * area * (polar + h.cx * h.cx + h.cy * h.cy);
  }
  return all;
}

double flat_kinetic(const FlatScene& scene, const std::vector<FlatState>& state) {
  double sum = 0;
  for (size_t i = 0; i < state.size(); ++i) {
    if (scene.bodies[i].kind == Kind::fixed) continue;
    const FlatMass m = flat_mass(scene.bodies[i]);
    const FlatState& s = state[i];
    sum += 0.5 * m.mass * (s.vx * s.vx + s.vy * s.vy) + 0.5 * m.inertia * s.spin * s.spin;
  }
  return sum;
}

double flat_error(const FlatScene& scene, const std::vector<FlatPose>& poses) {
  if (scene.collide) return deepest(scene, poses);
  double gap = 0;
  for (const FlatJoint& j : scene.joints) {
    const auto at = [&](int body, double x, double y) {
      const FlatPose& p = poses[static_cast<size_t>(body)];
      const double c = std::cos(p.angle), s = std::sin(p.angle);
      return Corner{p.x + c * x - s * y, p.y + s * x + c * y};
    };
    const Corner a = at(j.a, j.ax, j.ay), b = at(j.b, j.bx, j.by);
    gap = std::max(gap, std::hypot(a.x - b.x, a.y - b.y));
  }
  return gap;
}

}  // namespace truestep::bench
