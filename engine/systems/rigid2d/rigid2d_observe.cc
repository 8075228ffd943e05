// What is known of a rigid2d state as a whole: its energy, and what its sensors see.
#include <algorithm>
#include <cmath>

#include "engine/collision/flat/distance.h"
#include "engine/systems/rigid2d/joint_energy.h"
#include "engine/systems/rigid2d/rigid2d.h"

namespace truestep::rigid2d {

std::optional<Energy> Rigid2d::energy(const State& s, double, Workspace&, const ThreadArena&) const {
  const double *x = s.f64(columns::position).data(), *v = s.f64(columns::velocity).data();
  const auto w = s.f64(columns::angular_velocity), g = s.f64(columns::parameters);
  const auto status = s.span<uint32_t>(columns::status);
  const double down = std::sqrt(g[0] * g[0] + g[1] * g[1]), pushed = settings_.push_out_speed;
  Energy e;
  bool driven = joints_drive(model_, s) || columns::kHands.any(s);
  for (size_t i = 0; i < model_.count(); ++i) {
    const Body& b = model_.bodies[i];
    const Vec2 at{x[3 * i], x[3 * i + 1]}, u{v[3 * i], v[3 * i + 1]};
    driven = driven || b.surface_speed != 0;
    if (b.motion != Motion::dynamic || (status[i] & kRemoved)) {
      driven = driven || flat::dot(u, u) + w[i] * w[i] > 0;
      continue;
    }
    driven = driven || b.torque != 0 || flat::dot(b.force, b.force) > 0;
    e.kinetic += 0.5 * b.mass * flat::dot(u, u) + 0.5 * b.inertia * w[i] * w[i];
    e.potential -= b.mass * b.gravity_scale * (g[0] * at.x + g[1] * at.y);
    e.slack += b.mass * (0.5 * pushed * pushed + std::abs(b.gravity_scale) * down * b.reach);
  }
  e.potential += spring_energy(model_, s);
  e.exchange = driven ? Energy::Exchange::open : Energy::Exchange::closed;
  return e;
}

/// Pairs of a sensor and a dynamic body that overlap.
size_t Rigid2d::sensor_overlaps(const State& s) const {
  const auto status = s.span<uint32_t>(columns::status);
  const auto overlap = [&](const Body& a, const Pose& at_a, const Body& b, const Pose& at_b) {
    for (uint32_t i = a.first_shape; i < a.first_shape + a.shapes; ++i) {
      for (uint32_t j = b.first_shape; j < b.first_shape + b.shapes; ++j) {
        const Outline &p = model_.shapes[i].outline, &q = model_.shapes[j].outline;
        if (flat::bounds(p, at_a).overlaps(flat::bounds(q, at_b)) && flat::overlap(p, q, at_a.to(at_b)))
          return true;
      }
    }
    return false;
  };
  size_t count = 0;
  for (uint32_t i = 0; i < model_.count(); ++i) {
    const Body& sensor = model_.bodies[i];
    if (!sensor.sensor || (status[i] & kRemoved)) continue;
    const Pose at = pose_of(s, i);
    for (uint32_t j = 0; j < model_.count(); ++j) {
      const Body& b = model_.bodies[j];
      const bool seen = j != i && b.motion == Motion::dynamic && !b.sensor && !(status[j] & kRemoved) &&
                        (sensor.mask & b.category) && (b.mask & sensor.category);
      if (seen && overlap(sensor, at, b, pose_of(s, j))) ++count;
    }
  }
  return count;
}

}  // namespace truestep::rigid2d
