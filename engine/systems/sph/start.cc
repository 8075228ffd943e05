#include "engine/systems/sph/start.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/interrupt.h"
#include "engine/base/random.h"
#include "engine/core/state/real_column.h"
#include "engine/systems/sph/repeated.h"

namespace truestep::sph {

namespace {

Vec3 half_extent_of(const BodyDef& b) {
  return b.shape == Shape::ball ? Vec3{b.radius, b.radius, b.radius} : b.half_extents;
}

/// Initial pressures of standing liquid: liquid on the side of the box to which gravity along an axis points,
/// or on another body that stands. Falling liquid has none.
class StandingLiquid {
 public:
  StandingLiquid(const SphDef& d, const Vec3& gravity) : def_(d) {
    const double g[3] = {gravity.x, gravity.y, gravity.z};
    for (int a = 1; a < 3; ++a) axis_ = std::abs(g[a]) > std::abs(g[axis_]) ? a : axis_;
    weight_ = std::abs(g[axis_]), up_ = g[axis_] < 0 ? 1 : -1;
    if (d.wraps(axis_) || norm(gravity) > weight_ * (1 + 1e-9)) weight_ = 0;
    const double floor = up_ > 0 ? along(d.low) : -along(d.high);
    stands_.resize(d.bodies.size());
    const auto bottom = [&](const BodyDef& b) { return up_ * along(b.center) - along(half_extent_of(b)); };
    const auto on = [&](double low, double high) { return std::abs(low - high) <= 0.5 * d.spacing; };
    for (size_t pass = 0; pass < d.bodies.size(); ++pass) {
      for (size_t k = 0; k < d.bodies.size(); ++k) {
        const double low = bottom(d.bodies[k]);
        bool held = on(low, floor);
        for (size_t j = 0; j < d.bodies.size() && !held; ++j) {
          held = stands_[j] && on(low, bottom(d.bodies[j]) + 2 * along(half_extent_of(d.bodies[j])));
        }
        stands_[k] = held;
      }
    }
  }
  /// Pa, weight of the liquid above a point in body k.
  double pressure(size_t k, const Vec3& place) const {
    double out = 0;
    for (size_t j = 0; j < def_.bodies.size() && stands_[k]; ++j) {
      const BodyDef& b = def_.bodies[j];
      const Vec3 from = place - b.center;
      const double half = half_height(b, from), above = std::min(half - up_ * along(from), 2 * half);
      if (stands_[j]) out += b.density.value_or(def_.density) * weight_ * std::max(above, 0.0);
    }
    return out;
  }

 private:
  double along(const Vec3& v) const { return axis_ == 0 ? v.x : axis_ == 1 ? v.y : v.z; }
  /// m, half the length of a line along gravity inside a body; 0 where it misses.
  double half_height(const BodyDef& b, const Vec3& from) const {
    if (b.shape == Shape::ball) {
      const double beside = norm2(from) - along(from) * along(from);
      return std::sqrt(std::max(b.radius * b.radius - beside, 0.0));
    }
    const Vec3& half = b.half_extents;
    const bool in_x = axis_ == 0 || std::abs(from.x) <= half.x,
               in_y = axis_ == 1 || std::abs(from.y) <= half.y;
    const bool in_z = axis_ == 2 || def_.dimension == 2 || std::abs(from.z) <= half.z;
    return in_x && in_y && in_z ? along(half) : 0;
  }
  const SphDef& def_;
  int axis_ = 0;
  double weight_ = 0, up_ = 1;
  std::vector<char> stands_;
};

/// Relative density of Tait's equation at this pressure over density (m^2/s^2): a seventh root by Newton's
/// method.
double density_at(double pressure, double sound) {
  const double power = 1 + 7 * pressure / (sound * sound);
  double out = power;
  for (int k = 0; k < 200; ++k) {
    const double cube = out * out * out, next = out - (cube * cube * out - power) / (7 * cube * cube);
    if (!(next < out)) break;
    out = next;
  }
  return out;
}

}  // namespace

State start_of(const Setting& set, const Vec3& gravity) {
  const SphDef& d = set.def;
  const size_t n = set.rows;
  const Scalar real = d.precision == Precision::f32 ? Scalar::f32 : Scalar::f64;
  State s;
  s.add({"position", "m", real, 3, Role::position}, n);
  s.add({"velocity", "m/s", real, 3, Role::velocity}, n);
  s.add({"density", "1", real}, n);
  s.add({"pressure", "Pa", real}, n);
  s.add({"push", "m^2/s^2", real}, n);
  s.add({"flow", "m^2/s^2", real}, n);
  s.add({"gravity", "m/s^2", Scalar::f64, 3}, 1);
  s.add({"report", "1", Scalar::f64, static_cast<uint32_t>(report::count + (d.solves_viscosity() ? 1 : 0))},
        1);
  if (set.ratio) s.add({"ratio", "1", real}, n);
  if (set.counts) {
    s.add({"emitter.next_layer", "1", Scalar::u64}, set.inlets.size());
    s.add({"counts", "1", Scalar::u64}, counts::count);
    for (State::Column c = 0; c < columns::per_particle_end; ++c) s.reserve(c, set.capacity);
    if (set.ratio) s.reserve(set.ratio, set.capacity);
  }
  store3(s.f64(columns::gravity).data(), 0, gravity);
  RealColumn<double> x(s, columns::position), v(s, columns::velocity), density(s, columns::density);
  const StandingLiquid standing(d, gravity);
  size_t i = 0;
  for (size_t body = 0; body < d.bodies.size(); ++body) {
    const BodyDef& b = d.bodies[body];
    for (const Vec3& place : wet_places(set, b)) {
      const Vec3 r = place - b.center;
      x.set_vector(i, place);
      v.set_vector(i, b.velocity + cross(b.spin, r) +
                          Vec3{b.strain.x * r.x, b.strain.y * r.y, b.strain.z * r.z} + set.initial_at(place));
      // Standing water would ring for seconds if its weight had to compress it first.
      const bool carried = d.solver == Method::wcsph;
      density.set(i, carried ? density_at(standing.pressure(body, place) / d.density, set.sound) : 1);
      if (set.ratio) RealColumn<double>(s, set.ratio).set(i, b.density.value_or(d.density) / d.density);
      ++i;
    }
  }
  return s;
}

namespace {

/// The setting in which the liquid comes to rest: what moves at the start is left out, nothing pours, walls
/// stand, and hollows are solid.
Setting still_setting(const Setting& whole) {
  Setting set = whole;
  SphDef& d = set.def;
  std::erase_if(d.bodies, [](const BodyDef& b) { return !b.at_rest(); });
  d.emitters.clear(), d.initial.clear(), d.lid_velocity = {};
  // Where it rests does not depend on how thick it is.
  d.viscosity = 0;
  set.inlets.clear(), set.counts = set.layers = 0, set.initial = {};
  set.colliders = {};
  for (Collider c : whole.colliders.colliders()) c.motion = {}, set.colliders.add(std::move(c));
  for (MeshWall& m : set.meshes) m.collider.motion = {};
  for (const HollowDef& h : d.hollows) {
    set.images.push_back(images_of(d, h.solid()));
    set.colliders.add(h.solid());
  }
  set.rows = 0;
  for (const BodyDef& b : d.bodies) set.rows += wet_places(set, b).size();
  set.capacity = set.rows;
  return set;
}

template <class T>
void copy_rows(const State& from, size_t first, size_t rows, State& to, size_t place, State::Column c) {
  const size_t w = to.info(c).width;
  std::copy_n(from.span<T>(c).data() + first * w, rows * w, to.span<T>(c).data() + place * w);
}

/// Moves every particle by up to kDisorder spacings along each axis: on an even lattice nothing would decide
/// which way its rows give way.
void displace(State& s, const Setting& set) {
  constexpr double kDisorder = 0.02;
  constexpr uint64_t kSeed = 0x5e771e;
  RealColumn<double> x(s, columns::position);
  for (size_t i = 0; i < set.rows; ++i) {
    const auto u = uniform4(kSeed, 0, i);
    const double across = set.def.dimension == 3 ? 2 * u[2] - 1 : 0;
    x.set_vector(i, x.vector(i) + Vec3{2 * u[0] - 1, 2 * u[1] - 1, across} * (kDisorder * set.def.spacing));
  }
}

}  // namespace

void come_to_rest(const Setting& whole, const Vec3& gravity, double dt, State& s) {
  const Setting set = still_setting(whole);
  if (set.rows == 0) return;
  State still = start_of(set, gravity);
  displace(still, set);
  const auto solver = make_solver(set);
  Workspace workspace;
  const ThreadArena alone;
  const auto steps = static_cast<uint64_t>(std::ceil(set.def.settle / dt * (1 - 1e-9)));
  for (uint64_t k = 0; k < steps; ++k) {
    interruption_point();
    solver->step(
        still,
        {.t = static_cast<double>(k) * dt, .h = dt, .step = k, .workspace = workspace, .arena = alone});
  }
  size_t row = 0, from = 0;
  RealColumn<double> x(s, columns::position), v(s, columns::velocity);
  for (const BodyDef& b : whole.def.bodies) {
    const size_t rows = wet_places(whole, b).size();
    if (b.at_rest()) {
      for (const State::Column c :
           {columns::position, columns::density, columns::pressure, columns::push, columns::flow}) {
        if (s.info(c).type == Scalar::f32) {
          copy_rows<float>(still, from, rows, s, row, c);
        } else {
          copy_rows<double>(still, from, rows, s, row, c);
        }
      }
      for (size_t i = row; i < row + rows; ++i) v.set_vector(i, whole.initial_at(x.vector(i)));
      from += rows;
    }
    row += rows;
  }
}

}  // namespace truestep::sph
