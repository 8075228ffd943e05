#include "engine/systems/sph/walls.h"

namespace truestep::sph {

template <int D, class T>
auto BoxWalls<D, T>::walls_at(const double* x, double t) const -> Walls {
  const SphDef& d = set_.def;
  Walls out;
  for (int a = 0; a < D; ++a) {
    if (d.wraps(a)) continue;
    const double below = x[a] - low_[a], above = high_[a] - x[a];
    if (below < set_.support) out.wall[out.count++] = {below, axis(a, 1), Vec3{}};
    if (above < set_.support) out.wall[out.count++] = {above, axis(a, -1), a == 1 ? d.lid_velocity : Vec3{}};
  }
  out.sides = out.count;
  if (set_.colliders.empty()) return out;
  NearSurface near[Walls::kColliders];
  const size_t n =
      surfaces_within(set_.colliders, set_.images, {x[0], x[1], D == 3 ? x[2] : 0}, t, set_.support, near);
  for (size_t k = 0; k < n; ++k) out.wall[out.count++] = {near[k].distance, near[k].normal, near[k].velocity};
  return out;
}

template <int D, class T>
void BoxWalls<D, T>::shares(Fluid<D, T>& f, double t, const ThreadArena& arena) const {
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

template <int D, class T>
Vec3 BoxWalls<D, T>::lean(const double* x, const Vec3& gravity, double share, double t) const {
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

template <int D, class T>
Vec3 BoxWalls<D, T>::drag(const double* x, const Vec3& v, double t) const {
  Vec3 out;
  near(x, t, [&](double d, const Vec3& n, const Vec3& velocity, double full) {
    const Vec3 slip = velocity - v;
    const Vec3 along = slip - n * dot(slip, n);
    out += along * (set_.def.viscosity * full * set_.wall.friction(d, kLeastGap * set_.def.spacing));
  });
  return out;
}

template <int D, class T>
void BoxWalls<D, T>::keep_inside(T* x, T* v, double t) const {
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

template <int D, class T>
double BoxWalls<D, T>::beside(const Walls& w, size_t k) const {
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

template <int D, class T>
double BoxWalls<D, T>::free_of(const Walls& w) const {
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

template <int D, class T>
void BoxWalls<D, T>::lift(T* x, T* v, const Vec3& normal, const Vec3& velocity, double by) {
  const Vec3 u{double{v[0]}, double{v[1]}, D == 3 ? double{v[2]} : 0};
  const double into = std::min(dot(u - velocity, normal), 0.0);
  const double n[3] = {normal.x, normal.y, normal.z};
  for (int a = 0; a < D; ++a) x[a] += static_cast<T>(n[a] * by), v[a] -= static_cast<T>(n[a] * into);
}

template <int D, class T>
void BoxWalls<D, T>::keep_off_meshes(T* x, T* v, double t, double least) const {
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

template class BoxWalls<2, float>;
template class BoxWalls<3, float>;
template class BoxWalls<2, double>;
template class BoxWalls<3, double>;

}  // namespace truestep::sph
