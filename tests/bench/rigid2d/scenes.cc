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
  s.bodies.push_back({Kind::dynamic, -20, 0, 40, {{4, 4, 0, 0, 8}}});
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
  const Corner local[4] = {{-h.hx, low}, {h.hx, low}, {h.hx, high}, {-h.hx, high}};
  for (size_t i = 0; i < 4; ++i) {
    const double x = h.cx + local[i].x, y = h.cy + local[i].y;
    r.corner[i] = {p.x + c * x - s * y, p.y + s * x + c * y};
    r.left = std::min(r.left, r.corner[i].x), r.right = std::max(r.right, r.corner[i].x);
    r.low = std::min(r.low, r.corner[i].y), r.high = std::max(r.high, r.corner[i].y);
  }
  return r;
}

/// Smallest overlap over the normals of both boxes; 0 when an axis parts them.
double overlap(const Placed& a, const Placed& b) {
  double least = HUGE_VAL;
  for (const Placed* p : {&a, &b}) {
    for (size_t i = 0; i < 2; ++i) {
      const double ex = p->corner[i + 1].x - p->corner[i].x, ey = p->corner[i + 1].y - p->corner[i].y;
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
  // Swept from bottom to top: rows of pyramids keep the open list short, and wide grounds stay in it.
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
