// Contributions of the box's sides and the colliders to the sums of particles, and keeping particles off
// them. Shares of several walls combine as if the kernel were a product over directions, so that an edge is
// not counted twice: 1 - share = product of (1 - share of each).
#pragma once
#include "engine/systems/sph/fluid.h"

namespace truestep::sph {

/// Minimum distance of particles from every wall, in spacings.
inline constexpr double kLeastGap = 0.25;

/// m/s^2, the term missing for a fluid at rest if its mirror image in a wall has one pressure throughout: the
/// image's pressure continues the fluid's along a straight line (compare Adami, Hu & Adams 2012). The
/// integral over the wall of the kernel's gradient times the offset is -share, and -(share + d slope) across
/// it. This is that second part, for a wall at distance d (m) with outward normal n and slope `into` it.
inline Vec3 leaning(const Vec3& into, const Vec3& n, double d, const Vec3& gravity) {
  return into * (std::max(d, 0.0) * dot(gravity, n));
}

template <int D, class T>
class BoxWalls {
 public:
  explicit BoxWalls(const Setting& set) : set_(set) {
    const SphDef& d = set.def;
    const double lows[3] = {d.low.x, d.low.y, d.low.z}, highs[3] = {d.high.x, d.high.y, d.high.z};
    for (int a = 0; a < D; ++a) low_[a] = lows[a], high_[a] = highs[a];
  }

  /// visit(distance, normal into the fluid, velocity) for every wall within the kernel's reach of x at time
  /// t.
  template <class Visit>
  void near(const double* x, double t, const Visit& visit) const {
    const SphDef& d = set_.def;
    for (int a = 0; a < D; ++a) {
      if (d.wraps(a)) continue;
      const double below = x[a] - low_[a], above = high_[a] - x[a];
      if (below < set_.support) visit(below, axis(a, 1), Vec3{});
      if (above < set_.support) visit(above, axis(a, -1), a == 1 ? d.lid_velocity : Vec3{});
    }
    if (set_.colliders.empty()) return;
    const NearSurface s = set_.colliders.nearest({x[0], x[1], D == 3 ? x[2] : 0}, t);
    if (s.distance < set_.support) visit(s.distance, s.normal, s.velocity);
  }

  /// Gradient and share of all walls, and the rate of density due to their motion.
  void shares(Fluid<D, T>& f, double t, const ThreadArena& arena) const {
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const double x[3] = {double{f.x[0][i]}, double{f.x[1][i]}, D == 3 ? double{f.x[2][i]} : 0};
        double rest = 1, drive = 0;
        Vec3 slope;
        near(x, t, [&](double d, const Vec3& n, const Vec3& velocity) {
          const HalfSpace::At at = set_.wall.at(d);
          // d (1 - product) = sum of each slope times the others' factors 1 - share.
          const Vec3 g = n * -at.slope;
          slope = slope * (1 - at.share) + g * rest;
          drive = drive * (1 - at.share) - dot(g, velocity) * rest;
          rest *= 1 - at.share;
        });
        T* w = f.wall.data() + 4 * i;
        w[0] = static_cast<T>(slope.x), w[1] = static_cast<T>(slope.y);
        w[2] = D == 3 ? static_cast<T>(slope.z) : T{0};
        w[3] = static_cast<T>(1 - rest), f.drive[i] = static_cast<T>(drive);
      }
    });
  }

  /// m/s^2, effect of the weight of a fluid at rest on a particle at these walls; `share` is that of all.
  Vec3 lean(const double* x, const Vec3& gravity, double share, double t) const {
    Vec3 out;
    near(x, t, [&](double d, const Vec3& n, const Vec3&) {
      const HalfSpace::At at = set_.wall.at(d);
      const double beside_others = (1 - share) / std::max(1 - at.share, 1e-6);
      out += leaning(n * (-at.slope * beside_others), n, d, gravity);
    });
    return out;
  }

  /// m/s^2, drag of no-slip walls on a particle at x with velocity v.
  Vec3 drag(const double* x, const Vec3& v, double t) const {
    Vec3 out;
    near(x, t, [&](double d, const Vec3& n, const Vec3& velocity) {
      const Vec3 slip = velocity - v;
      const Vec3 along = slip - n * dot(slip, n);
      out += along * (set_.def.viscosity * set_.wall.friction(d, kLeastGap * set_.def.spacing));
    });
    return out;
  }

  /// Moves a particle that is too close to a wall back off it, and removes its velocity into the wall; a
  /// particle that has left through a periodic side stays outside.
  void keep_inside(T* x, T* v, double t) const {
    const double least = kLeastGap * set_.def.spacing;
    if (!set_.colliders.empty()) {
      const NearSurface s =
          set_.colliders.nearest({double{x[0]}, double{x[1]}, D == 3 ? double{x[2]} : 0}, t);
      if (s.distance < least) {
        const Vec3 u{double{v[0]}, double{v[1]}, D == 3 ? double{v[2]} : 0};
        const double into = std::min(dot(u - s.velocity, s.normal), 0.0);
        const double n[3] = {s.normal.x, s.normal.y, s.normal.z};
        for (int a = 0; a < D; ++a) {
          x[a] += static_cast<T>(n[a] * (least - s.distance));
          v[a] -= static_cast<T>(n[a] * into);
        }
      }
    }
    for (int a = 0; a < D; ++a) {
      if (set_.def.wraps(a)) continue;
      const T low = static_cast<T>(low_[a]), high = static_cast<T>(high_[a]);
      const T from = low + static_cast<T>(least), to = high - static_cast<T>(least);
      if (x[a] < from) x[a] = from, v[a] = std::max(v[a], T{0});
      if (x[a] > to) x[a] = to, v[a] = std::min(v[a], T{0});
    }
  }

  /// The same, then wraps the particle through periodic sides.
  void keep_off(T* x, T* v, double t) const { keep_inside(x, v, t), wrap(x); }

  /// Wraps a position into the box through its periodic sides.
  void wrap(T* x) const {
    for (int a = 0; a < D; ++a) {
      if (!set_.def.wraps(a)) continue;
      const T low = static_cast<T>(low_[a]), high = static_cast<T>(high_[a]), width = high - low;
      if (x[a] < low) x[a] += width;
      if (x[a] >= high) x[a] -= width;
      x[a] = std::min(std::max(x[a], low), high);
    }
  }

 private:
  static Vec3 axis(int a, double sign) { return {a == 0 ? sign : 0, a == 1 ? sign : 0, a == 2 ? sign : 0}; }
  const Setting& set_;
  double low_[3] = {}, high_[3] = {};
};

}  // namespace truestep::sph
