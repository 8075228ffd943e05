// Contributions of the box's sides and the colliders to the sums of particles, and keeping particles off
// them. Shares of several walls combine as if the kernel were a product over directions, so that an edge is
// not counted twice: 1 - share = product of (1 - share of each). Walls that meet a collider at other than
// right angles combine as half spaces do under a Gaussian: of a wall's slope, the part counts that lies, in
// its plane, outside the others.
#pragma once
#include "engine/collision/points/near_surfaces.h"
#include "engine/math/trig.h"
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

  /// A wall within the kernel's reach of a place: distance (m), normal into the fluid, velocity (m/s).
  struct Wall {
    double d;
    Vec3 n, velocity;
  };
  /// The walls at a place: sides of the box, then colliders.
  struct Walls {
    static constexpr size_t kSides = 6, kColliders = 8;
    size_t count = 0, sides = 0;
    Wall wall[kSides + kColliders];
    /// Whether two of them, at least one of which is a collider, meet at other than a right angle or face
    /// each other.
    bool skew() const {
      for (size_t k = sides; k < count; ++k) {
        for (size_t j = 0; j < k; ++j) {
          if (std::abs(dot(wall[j].n, wall[k].n)) > kRight) return true;
        }
      }
      return false;
    }
  };
  Walls walls_at(const double* x, double t) const {
    const SphDef& d = set_.def;
    Walls out;
    for (int a = 0; a < D; ++a) {
      if (d.wraps(a)) continue;
      const double below = x[a] - low_[a], above = high_[a] - x[a];
      if (below < set_.support) out.wall[out.count++] = {below, axis(a, 1), Vec3{}};
      if (above < set_.support)
        out.wall[out.count++] = {above, axis(a, -1), a == 1 ? d.lid_velocity : Vec3{}};
    }
    out.sides = out.count;
    if (set_.colliders.empty()) return out;
    NearSurface near[Walls::kColliders];
    const size_t n =
        surfaces_within(set_.colliders, set_.images, {x[0], x[1], D == 3 ? x[2] : 0}, t, set_.support, near);
    for (size_t k = 0; k < n; ++k)
      out.wall[out.count++] = {near[k].distance, near[k].normal, near[k].velocity};
    return out;
  }

  /// visit(distance, normal into the fluid, velocity, slope across it over that of a flat wall) for every
  /// wall within the kernel's reach of x at time t.
  template <class Visit>
  void near(const double* x, double t, const Visit& visit) const {
    const Walls w = walls_at(x, t);
    for (size_t k = 0; k < w.count; ++k) visit(w.wall[k].d, w.wall[k].n, w.wall[k].velocity, 1.0);
    each_mesh(place_of(x), t, set_.support, [&](const MeshWall& mesh, const Vec3& place) {
      const auto at = mesh.at(place, t, set_.wall, set_.support);
      if (at) visit(at->surface.distance, at->surface.normal, at->velocity, at->full);
    });
  }

  /// Gradient and share of all walls, and the rate of density due to their motion.
  void shares(Fluid<D, T>& f, double t, const ThreadArena& arena) const {
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const double x[3] = {double{f.x[0][i]}, double{f.x[1][i]}, D == 3 ? double{f.x[2][i]} : 0};
        double rest = 1, drive = 0;
        Vec3 slope;
        const Walls walls = walls_at(x, t);
        const bool skew = walls.skew();
        for (size_t k = 0; k < walls.count; ++k) {
          const auto& [d, n, velocity] = walls.wall[k];
          const HalfSpace::At at = set_.wall.at(d);
          if (skew) {
            const Vec3 g = n * (-at.slope * beside(walls, k));
            slope += g, drive -= dot(g, velocity);
            continue;
          }
          // d (1 - product) = sum of each slope times the others' factors 1 - share.
          const Vec3 g = n * -at.slope;
          slope = slope * (1 - at.share) + g * rest;
          drive = drive * (1 - at.share) - dot(g, velocity) * rest;
          rest *= 1 - at.share;
        }
        if (skew) rest = free_of(walls);
        each_mesh(place_of(x), t, set_.support, [&](const MeshWall& mesh, const Vec3& place) {
          const auto at = mesh.at(place, t, set_.wall, set_.support);
          if (!at) return;
          slope = slope * (1 - at->share) + at->slope * rest;
          drive = drive * (1 - at->share) - dot(at->slope, at->velocity) * rest;
          rest *= 1 - at->share;
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
    const Walls walls = walls_at(x, t);
    const bool skew = walls.skew();
    double beside_meshes = 1;
    each_mesh(place_of(x), t, set_.support, [&](const MeshWall& mesh, const Vec3& place) {
      const auto at = mesh.at(place, t, set_.wall, set_.support);
      if (!at) return;
      out += at->lean(gravity) * ((1 - share) / std::max(1 - at->share, 1e-6));
      beside_meshes *= 1 - at->share;
    });
    for (size_t k = 0; k < walls.count; ++k) {
      const auto& [d, n, velocity] = walls.wall[k];
      const HalfSpace::At at = set_.wall.at(d);
      const double beside_others =
          skew ? beside(walls, k) * beside_meshes : (1 - share) / std::max(1 - at.share, 1e-6);
      out += leaning(n * (-at.slope * beside_others), n, d, gravity);
    }
    return out;
  }

  /// m/s^2, drag of no-slip walls on a particle at x with velocity v.
  Vec3 drag(const double* x, const Vec3& v, double t) const {
    Vec3 out;
    near(x, t, [&](double d, const Vec3& n, const Vec3& velocity, double full) {
      const Vec3 slip = velocity - v;
      const Vec3 along = slip - n * dot(slip, n);
      out += along * (set_.def.viscosity * full * set_.wall.friction(d, kLeastGap * set_.def.spacing));
    });
    return out;
  }

  /// Moves a particle that is too close to a wall back off it, and removes its velocity into the wall; a
  /// particle that has left through a periodic side stays outside.
  void keep_inside(T* x, T* v, double t) const {
    const double least = kLeastGap * set_.def.spacing;
    // Off the nearest collider, then off those that this brings it too close to.
    NearSurface last{.normal = {}, .velocity = {}};
    for (size_t k = 0; k < kMostCorrected && !set_.colliders.empty(); ++k) {
      NearSurface s;
      const size_t found = surfaces_within(set_.colliders, set_.images, place_of(x), t, least, {&s, 1});
      if (found == 0 || (s.collider == last.collider && s.shift == last.shift)) break;
      last = s;
      lift(x, v, s.normal, s.velocity, least - s.distance);
    }
    if (!set_.meshes.empty()) keep_off_meshes(x, v, t, least);
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
  static constexpr double kRight = 1e-6;       ///< cosine, below which walls meet at right angles
  static constexpr size_t kMostCorrected = 4;  ///< colliders that a particle is moved off, one after another

  /// 1, fraction of the kernel's slice in the plane of wall k that lies outside all others. Seen from the
  /// foot there, the border of wall j is (d_j - c d_k) / sqrt(1 - c^2) away, c the cosine of their normals.
  double beside(const Walls& w, size_t k) const {
    double out = 1;
    for (size_t j = 0; j < w.count; ++j) {
      if (j == k) continue;
      const double c = dot(w.wall[j].n, w.wall[k].n);
      const bool right = std::abs(c) <= kRight || std::max(j, k) < w.sides;
      const double across = right ? 1 : std::sqrt(std::max(1 - c * c, 1e-12));
      const double away = right ? w.wall[j].d : (w.wall[j].d - c * w.wall[k].d) / across;
      out *= 1 - set_.wall.share_at(away);
    }
    return out;
  }
  /// 1, fraction of the kernel outside all walls. Of two half spaces with shares s and r that both contain
  /// half of a Gaussian, s r + (2 asin(c) / pi) (min(s, r) - s r) overlaps; for opposite ones max(0, s + r -
  /// 1) takes the minimum's place.
  double free_of(const Walls& w) const {
    constexpr double kTwoOverPi = 0.636619772367581343;
    double out = 1, most = 1;
    for (size_t k = 0; k < w.count; ++k) {
      const double s = set_.wall.share_at(w.wall[k].d);
      most = std::min(most, 1 - s), out *= 1 - s;
      for (size_t j = 0; j < k; ++j) {
        const double c = dot(w.wall[j].n, w.wall[k].n);
        if (std::abs(c) <= kRight || k < w.sides) continue;
        const double r = set_.wall.share_at(w.wall[j].d), apart = (1 - s) * (1 - r);
        const double bound = c > 0 ? std::min(s, r) - s * r : s * r - std::max(s + r - 1, 0.0);
        const double more = kTwoOverPi * trig::asin(std::clamp(c, -1.0, 1.0)) * bound;
        out *= std::max(apart + more, 0.0) / std::max(apart, 1e-6);
      }
    }
    return std::min(out, most);
  }
  /// Moves a particle by `by` (m) along a wall's normal, and removes its velocity into the wall.
  static void lift(T* x, T* v, const Vec3& normal, const Vec3& velocity, double by) {
    const Vec3 u{double{v[0]}, double{v[1]}, D == 3 ? double{v[2]} : 0};
    const double into = std::min(dot(u - velocity, normal), 0.0);
    const double n[3] = {normal.x, normal.y, normal.z};
    for (int a = 0; a < D; ++a) x[a] += static_cast<T>(n[a] * by), v[a] -= static_cast<T>(n[a] * into);
  }
  /// Off the nearest face, then off those that this brings it too close to, of the same mesh too.
  void keep_off_meshes(T* x, T* v, double t, double least) const {
    constexpr double kCloseEnough = 1 - 1e-4;  // of `least`: coordinates are rounded
    for (size_t k = 0; k < kMostCorrected; ++k) {
      const Vec3 place = place_of(x);
      const MeshWall* nearest = nullptr;
      MeshWall::Surface s{.distance = kCloseEnough * least, .normal = {}};
      Vec3 from;
      each_mesh(place, t, set_.support, [&](const MeshWall& mesh, const Vec3& seen) {
        const auto near = mesh.surface(seen, t, least, set_.support);
        if (near && near->distance < s.distance) nearest = &mesh, s = *near, from = seen;
      });
      if (!nearest) return;
      lift(x, v, s.normal, nearest->collider.velocity_at(from, t), least - s.distance);
    }
  }
  /// visit(mesh, place) for the meshes and their images that reach within `reach` (m) of a place; the place
  /// is as the image sees it.
  template <class Visit>
  void each_mesh(const Vec3& x, double t, double reach, const Visit& visit) const {
    for (const MeshWall& mesh : set_.meshes)
      mesh.each_place(x, t, reach, [&](const Vec3& place) { visit(mesh, place); });
  }
  template <class Real>
  static Vec3 place_of(const Real* x) {
    return {double{x[0]}, double{x[1]}, D == 3 ? double{x[2]} : 0};
  }
  static Vec3 axis(int a, double sign) { return {a == 0 ? sign : 0, a == 1 ? sign : 0, a == 2 ? sign : 0}; }
  const Setting& set_;
  double low_[3] = {}, high_[3] = {};
};

}  // namespace truestep::sph
