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
  Walls walls_at(const double* x, double t) const;

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
  void shares(Fluid<D, T>& f, double t, const ThreadArena& arena) const;

  /// m/s^2, effect of the weight of a fluid at rest on a particle at these walls; `share` is that of all.
  Vec3 lean(const double* x, const Vec3& gravity, double share, double t) const;

  /// m/s^2, drag of no-slip walls on a particle at x with velocity v.
  Vec3 drag(const double* x, const Vec3& v, double t) const;

  /// Moves a particle that is too close to a wall back off it, and removes its velocity into the wall; a
  /// particle that has left through a periodic side stays outside.
  void keep_inside(T* x, T* v, double t) const;

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
  double beside(const Walls& w, size_t k) const;
  /// 1, fraction of the kernel outside all walls. Of two half spaces with shares s and r that both contain
  /// half of a Gaussian, s r + (2 asin(c) / pi) (min(s, r) - s r) overlaps; for opposite ones max(0, s + r -
  /// 1) takes the minimum's place.
  double free_of(const Walls& w) const;
  /// Moves a particle by `by` (m) along a wall's normal, and removes its velocity into the wall.
  static void lift(T* x, T* v, const Vec3& normal, const Vec3& velocity, double by);
  /// Off the nearest face, then off those that this brings it too close to, of the same mesh too.
  void keep_off_meshes(T* x, T* v, double t, double least) const;
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
