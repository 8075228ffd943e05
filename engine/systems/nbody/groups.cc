#include "engine/systems/nbody/groups.h"

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/math/trig.h"
#include "engine/systems/nbody/attraction.h"

namespace truestep::nbody {

namespace {

constexpr double kTurn = 6.283185307179586;

/// Numbers in [0, 1) for one body of one group, four at a time.
class Draws {
 public:
  Draws(uint64_t seed, size_t group, size_t body) : seed_(seed), stream_((uint64_t{group} << 32) + body) {}
  double next() {
    if (at_ == 4) four_ = uniform4(seed_, stream_, counter_++), at_ = 0;
    return four_[at_++];
  }
  Vec3 direction() {
    const double z = 2 * next() - 1, s = std::sqrt(std::max(0.0, 1 - z * z));
    const trig::SinCos phi = trig::sincos(kTurn * next());
    return {s * phi.cos, s * phi.sin, z};
  }
  /// Of variance 1 (Box & Muller 1958).
  double normal() {
    const double u = 1 - next();
    return std::sqrt(-2 * trig::log(u)) * trig::cos(kTurn * next());
  }

 private:
  uint64_t seed_, stream_, counter_ = 0;
  std::array<double, 4> four_{};
  size_t at_ = 4;
};

/// Removes the group's own mean position and velocity, so that its centre is where it was requested.
void center_on(std::vector<Body>& bodies, const Placed& place) {
  Vec3 x, v;
  double mass = 0;
  for (const Body& b : bodies) x += b.x * b.mass, v += b.v * b.mass, mass += b.mass;
  for (Body& b : bodies) b.x += place.center - x / mass, b.v += place.velocity - v / mass;
}

/// Radius that contains a fraction u of a Plummer sphere with a = 1.
double plummer_radius(double u) {
  return 1 / std::sqrt(trig::pow(u, -2.0 / 3) - 1);
}

Body plummer_body(Draws& draw, const PlummerDef& d, double mass, double g) {
  const double within = trig::pow(1 + 1 / (d.cut * d.cut), -1.5);  // fraction inside the cut
  const double r = plummer_radius(std::max(draw.next(), 1e-10) * within);
  const Vec3 x = draw.direction() * (d.radius * r);
  // The ratio q of speed to escape speed is distributed as q^2 (1 - q^2)^(7/2), which is below 0.1
  // everywhere.
  double q, p;
  do {
    q = draw.next(), p = 0.1 * draw.next();
  } while (p > q * q * (1 - q * q) * (1 - q * q) * (1 - q * q) * std::sqrt(1 - q * q));
  const double escape = std::sqrt(2 * g * d.mass / (d.radius * std::sqrt(1 + r * r)));
  return {x, draw.direction() * (q * escape), mass};
}

std::vector<Body> make(const PlummerDef& d, uint64_t seed, size_t group, double g) {
  std::vector<Body> out;
  for (size_t i = 0; i < static_cast<size_t>(d.count); ++i) {
    Draws draw(seed, group, i);
    out.push_back(plummer_body(draw, d, d.mass / static_cast<double>(d.count), g));
  }
  center_on(out, d);
  return out;
}

std::vector<Body> make(const SphereDef& d, uint64_t seed, size_t group, double g) {
  std::vector<Body> out;
  // |W| = 3/5 G M^2/R, so that K = M 3/2 sigma^2 gives sigma^2 = ratio G M/(5 R).
  const double sigma = std::sqrt(d.virial_ratio * g * d.mass / (5 * d.radius));
  for (size_t i = 0; i < static_cast<size_t>(d.count); ++i) {
    Draws draw(seed, group, i);
    const double r = d.radius * trig::pow(draw.next(), 1.0 / 3);
    const Vec3 x = draw.direction() * r;
    Vec3 v;
    if (sigma > 0) v = Vec3{draw.normal(), draw.normal(), draw.normal()} * sigma;
    out.push_back({x, v, d.mass / static_cast<double>(d.count)});
  }
  center_on(out, d);
  return out;
}

/// Two directions perpendicular to `axis`, which is normalised.
struct Frame {
  Vec3 a, b, axis;
  explicit Frame(const Vec3& along) : axis(normalized(along)) {
    const Vec3 other = std::abs(axis.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    a = normalized(other - axis * dot(other, axis)), b = cross(axis, a);
  }
};

/// x with 1 - (1 + x) exp(-x) = u: the radius that contains a fraction u of an exponential disk.
double disk_radius(double u) {
  double low = 0, high = 40;
  for (int k = 0; k < 60; ++k) {
    const double x = 0.5 * (low + high);
    (1 - (1 + x) * trig::exp(-x) < u ? low : high) = x;
  }
  return low;
}

std::vector<Body> make(const GalaxyDef& d, uint64_t seed, size_t group, const NbodyDef& def) {
  const double g = def.gravitational_constant;
  const Frame frame(d.axis);
  std::vector<Body> out;
  if (d.central_mass > 0) out.push_back({{}, {}, d.central_mass});
  const size_t first = out.size(), disk = static_cast<size_t>(d.count);
  for (size_t i = 0; i < disk; ++i) {
    Draws draw(seed, group, i);
    const double r = d.scale_length * disk_radius(draw.next() * 0.995);
    const trig::SinCos phi = trig::sincos(kTurn * draw.next());
    const double u = 2 * std::clamp(draw.next(), 1e-9, 1 - 1e-9) - 1;
    const double z = d.height * 0.5 * trig::log((1 + u) / (1 - u));
    out.push_back({frame.a * (r * phi.cos) + frame.b * (r * phi.sin) + frame.axis * z,
                   {},
                   d.mass / static_cast<double>(disk)});
  }
  const PlummerDef halo{{}, d.halo_count, d.halo_mass, d.halo_radius, 6};
  for (size_t i = 0; i < static_cast<size_t>(d.halo_count); ++i) {
    Draws draw(seed, group, disk + i);
    out.push_back(plummer_body(draw, halo, d.halo_mass / static_cast<double>(d.halo_count), g));
    // The disk and the central mass bind the halo too.
    out.back().v *= std::sqrt(1 + (d.mass + d.central_mass) / d.halo_mass);
  }
  // Circular orbits in the field of this whole galaxy.
  const std::vector<Vec3> a = attraction_at_start(out, def);
  for (size_t i = first; i < first + disk; ++i) {
    Draws draw(seed, group, out.size() + i);
    Body& b = out[i];
    const Vec3 across = b.x - frame.axis * dot(b.x, frame.axis);
    const double r = norm(across), inward = -dot(a[i], across) / std::max(r, 1e-300);
    const double speed = std::sqrt(std::max(inward, 0.0) * r), sigma = d.dispersion * speed;
    const Vec3 u{draw.normal(), draw.normal(), draw.normal()};  // in braces: evaluated in this order
                                                                // everywhere
    b.v = normalized(cross(frame.axis, across)) * speed +
          (frame.a * u.x + frame.b * u.y + frame.axis * u.z) * sigma;
  }
  center_on(out, d);
  return out;
}

std::vector<Body> make(const RingDef& d, uint64_t seed, size_t group, double g, const Body& middle) {
  const Frame frame(d.axis);
  std::vector<Body> out;
  for (size_t i = 0; i < static_cast<size_t>(d.count); ++i) {
    Draws draw(seed, group, i);
    // Uniform in area.
    const double inner2 = d.inner_radius * d.inner_radius, outer2 = d.outer_radius * d.outer_radius;
    const double r = std::sqrt(inner2 + draw.next() * (outer2 - inner2));
    const trig::SinCos phi = trig::sincos(kTurn * draw.next());
    const Vec3 out_x = frame.a * phi.cos + frame.b * phi.sin;
    const Vec3 x = out_x * r + frame.axis * (d.thickness * (draw.next() - 0.5));
    const Vec3 v = cross(frame.axis, out_x) * std::sqrt(g * middle.mass / r);
    out.push_back({middle.x + x, middle.v + v, d.mass / static_cast<double>(d.count), d.body_radius});
  }
  return out;
}

/// E with M = E - e sin E, by Newton's method from E = M + e sin M, damped when e is near 1.
double eccentric_anomaly(double mean, double e) {
  double at = mean + e * trig::sin(mean);
  for (int k = 0; k < 50; ++k) {
    const trig::SinCos sc = trig::sincos(at);
    const double step = (at - e * sc.sin - mean) / (1 - e * sc.cos);
    at -= std::clamp(step, -1.0, 1.0);
    if (std::abs(step) < 1e-15) break;
  }
  return at;
}

Body make(const OrbitDef& d, double g, const Body& middle) {
  const double mean = d.mean_anomaly - kTurn * std::floor(d.mean_anomaly / kTurn + 0.5), e = d.eccentricity;
  const trig::SinCos at = trig::sincos(eccentric_anomaly(mean, e));
  const double a = d.semi_major_axis, share = std::sqrt(1 - e * e), mu = g * (middle.mass + d.mass);
  const double r = a * (1 - e * at.cos), rate = std::sqrt(mu * a) / r;
  const double px = a * (at.cos - e), py = a * share * at.sin, vx = -rate * at.sin,
               vy = rate * share * at.cos;
  const trig::SinCos o = trig::sincos(d.ascending_node), w = trig::sincos(d.periapsis),
                     i = trig::sincos(d.inclination);
  const Vec3 p{o.cos * w.cos - o.sin * w.sin * i.cos, o.sin * w.cos + o.cos * w.sin * i.cos, w.sin * i.sin};
  const Vec3 q{-o.cos * w.sin - o.sin * w.cos * i.cos, -o.sin * w.sin + o.cos * w.cos * i.cos, w.cos * i.sin};
  return {middle.x + p * px + q * py, middle.v + p * vx + q * vy, d.mass, d.radius};
}

}  // namespace

std::vector<Body> bodies_at_start(const NbodyDef& d, uint64_t seed) {
  const double g = d.gravitational_constant;
  std::vector<Body> out;
  out.reserve(body_count(d));
  for (size_t i = 0; i < d.positions.size(); ++i) {
    out.push_back({d.positions[i], d.velocities.empty() ? Vec3{} : d.velocities[i],
                   d.masses.empty() ? d.mass : d.masses[i], d.radii.empty() ? d.radius : d.radii[i]});
  }
  for (size_t k = 0; k < d.groups.size(); ++k) {
    std::vector<Body> more;
    if (const auto* plummer = std::get_if<PlummerDef>(&d.groups[k])) more = make(*plummer, seed, k, g);
    if (const auto* sphere = std::get_if<SphereDef>(&d.groups[k])) more = make(*sphere, seed, k, g);
    if (const auto* galaxy = std::get_if<GalaxyDef>(&d.groups[k])) more = make(*galaxy, seed, k, d);
    if (const auto* ring = std::get_if<RingDef>(&d.groups[k])) {
      more = make(*ring, seed, k, g, out[static_cast<size_t>(ring->around)]);
    }
    if (const auto* orbit = std::get_if<OrbitDef>(&d.groups[k])) {
      more = {make(*orbit, g, out[static_cast<size_t>(orbit->around)])};
    }
    for (Body& b : more) {
      if (!std::holds_alternative<OrbitDef>(d.groups[k]) && b.radius == 0) b.radius = d.radius;
      out.push_back(b);
    }
  }
  return out;
}

}  // namespace truestep::nbody
