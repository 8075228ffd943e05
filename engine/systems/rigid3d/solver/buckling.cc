#include "engine/systems/rigid3d/solver/buckling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/rigid/islands.h"

namespace truestep::rigid3d {

namespace {

/// Minimum load of a contact, in weights of its lighter body, for buckling: a fraction of what five substeps
/// can hold of cubes.
constexpr double kTallLoad = 3;
/// .. and for yielding.
constexpr double kGivingLoad = 10;
/// Below the first quotient substeps are added until it is reached; above the second fewer are tried.
constexpr double kStiff = 1.1, kMoreThanStiff = 2.2;
/// A contact under such loads may yield by this fraction of the smaller body's reach.
constexpr double kMostGive = 0.015;
/// m/s; faster bodies are falling or in flight.
constexpr double kStands = 0.5;

/// integral_0^s of (t (2 - t))^2.
double squared_tilts(double s) {
  return s * s * s * (4.0 / 3 - s + 0.2 * s * s);
}

/// 1/kg of a body for pushes along n at an arm (m) from its centre.
double mobility(const BodyKind& k, const Rotation& turned, const Vec3& arm, const Vec3& n) {
  const Vec3 turn = turned.apply_inverse(cross(arm, n)), I = k.resistance();
  return 1 / k.mass + turn.x * turn.x / I.x + turn.y * turn.y / I.y + turn.z * turn.z / I.z;
}

}  // namespace

double BucklingWatch::Support::least() const {
  if (!(mass > 0)) return 0;
  const Vec3 c = place / mass;
  const double xx = squares.x - c.x * place.x, yy = squares.y - c.y * place.y, zz = squares.z - c.z * place.z;
  const double yz = products.x - c.y * place.z, xz = products.y - c.x * place.z,
               xy = products.z - c.x * place.y;
  // The arms lie in a plane: one eigenvalue is zero.
  const double sum = xx + yy + zz;
  const double product = xx * yy + yy * zz + zz * xx - yz * yz - xz * xz - xy * xy;
  return std::max(0.0, 0.5 * (sum - std::sqrt(std::max(0.0, sum * sum - 4 * product))));
}

int BucklingWatch::substeps(const State& s, std::span<const BodyKind> kinds,
                            std::span<Contact* const> contacts, const SolverSettings& settings, int now,
                            double h) {
  const auto kind = s.span<uint32_t>(columns::kind);
  const auto asleep = s.span<uint32_t>(columns::asleep);
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data(),
               *v = s.f64(columns::velocity).data(), *rested = s.f64(columns::sleep_timer).data();
  const Vec3 gravity = load3(s.f64(columns::gravity).data(), 0);
  const double g = norm(gravity), substep = s.f64(columns::substep)[0];
  if (!(g > 0) || !(substep > 0)) return settings.substeps;

  const auto moves = [&](uint32_t i) {
    return kinds[kind[i]].moved_by_forces() && !asleep[i] && !is_led(rested, i);
  };
  const auto load = [&](const Contact& c) {
    return (c.impulse[0] + c.impulse[1] + c.impulse[2] + c.impulse[3]) / substep;
  };
  const double rate = contact_rate(settings, h / now);
  // 1/kg of a contact's points for pushes along its normal, computed once.
  inverse_mass_.assign(contacts.size(), {});
  const auto inverse_masses = [&](size_t k) -> const auto& {
    const Contact& c = *contacts[k];
    auto& inverse = inverse_mass_[k];
    if (c.manifold.count == 0 || inverse[0] > 0) return inverse;
    for (const uint32_t i : {c.a, c.b}) {
      if (!moves(i)) continue;
      const Rotation turned = rotation(load_quat(q, i));
      for (int p = 0; p < c.manifold.count; ++p) {
        const Vec3 arm = c.manifold.points[p].position - load3(x, i);
        inverse[static_cast<size_t>(p)] += mobility(kinds[kind[i]], turned, arm, c.manifold.normal);
      }
    }
    return inverse;
  };
  const auto yield = [&](size_t k) {
    double stiffness = 0;
    const auto& inverse = inverse_masses(k);
    for (int p = 0; p < contacts[k]->manifold.count; ++p) {
      stiffness += rate * rate / inverse[static_cast<size_t>(p)];
    }
    return load(*contacts[k]) / stiffness;
  };
  bool tall = false;
  double gives_way = 0;  // yield, as a fraction of the allowed yield
  for (size_t k = 0; k < contacts.size(); ++k) {
    const Contact* c = contacts[k];
    double lightest = std::numeric_limits<double>::max(), smallest = lightest;
    bool stands = true;
    for (const uint32_t i : {c->a, c->b}) {
      if (!moves(i)) continue;
      stands &= norm2(load3(v, i)) < kStands * kStands;
      lightest = std::min(lightest, kinds[kind[i]].mass), smallest = std::min(smallest, kinds[kind[i]].reach);
    }
    const double weights = load(*c) / (lightest * g);
    tall |= weights > kTallLoad;
    if (weights > kGivingLoad && stands) gives_way = std::max(gives_way, yield(k) / (kMostGive * smallest));
  }
  if (!tall) return settings.substeps;

  const Vec3 up = gravity * (-1 / g);
  const auto height = [&](uint32_t i) { return dot(load3(x, i), up); };
  parent_.resize(kind.size()), start_islands(parent_);
  for (const Contact* c : contacts) {
    if (moves(c->a) && moves(c->b)) link_islands(parent_, c->a, c->b);
  }
  island_.assign(kind.size(), {std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()});
  for (uint32_t i = 0; i < kind.size(); ++i) {
    if (!moves(i)) continue;
    Island& all = island_[island_of(parent_, i)];
    all.low = std::min(all.low, height(i)), all.high = std::max(all.high, height(i));
  }
  const auto place = [&](const Island& all, double z) {
    return std::clamp((z - all.low) / std::max(all.high - all.low, 1e-9), 0.0, 1.0);
  };
  const auto tilt = [&](uint32_t i) {
    if (!moves(i)) return 0.0;
    const double t = place(island_[island_of(parent_, i)], height(i));
    return t * (2 - t);
  };
  support_.assign(kind.size(), {});
  for (size_t k = 0; k < contacts.size(); ++k) {
    const Contact* c = contacts[k];
    if (!(load(*c) > 0)) continue;
    const bool on_a = !moves(c->a) || (moves(c->b) && height(c->b) > height(c->a));
    const uint32_t upper = on_a ? c->b : c->a, lower = on_a ? c->a : c->b;
    if (!moves(upper)) continue;
    const Manifold& m = c->manifold;
    if (m.count < 3) island_[island_of(parent_, upper)].counts = false;
    Support& support = support_[upper];
    const double upright = dot(m.normal, up), below = tilt(lower);
    const auto& inverse = inverse_masses(k);
    for (int p = 0; p < m.count; ++p) {
      const Vec3 at = m.points[p].position, arm_a = at - load3(x, c->a), arm_b = at - load3(x, c->b);
      const double mass = upright * upright / inverse[static_cast<size_t>(p)];
      const Vec3 all = on_a ? arm_b : arm_a, arm = all - up * dot(all, up);
      support.mass += mass, support.tilt += mass * below, support.place += arm * mass;
      support.squares += Vec3{arm.x * arm.x, arm.y * arm.y, arm.z * arm.z} * mass;
      support.products += Vec3{arm.y * arm.z, arm.x * arm.z, arm.x * arm.y} * mass;
    }
  }
  for (uint32_t i = 0; i < kind.size(); ++i) {
    if (!moves(i)) continue;
    Island& all = island_[island_of(parent_, i)];
    all.counts &= norm2(load3(v, i)) < kStands * kStands;
    all.load += kinds[kind[i]].mass * g * (all.high - all.low) * squared_tilts(place(all, height(i)));
    const Support& support = support_[i];
    if (!(support.mass > 0)) continue;
    const double turn = tilt(i) - support.tilt / support.mass;
    all.stiffness += rate * rate * support.least() * turn * turn;
  }
  double least = kMoreThanStiff;
  for (const Island& all : island_) {
    if (all.counts && all.load > 0) least = std::min(least, all.stiffness / all.load);
  }
  const bool enough = least >= kStiff && (now == settings.substeps || least < kMoreThanStiff);
  const double standing = enough ? now : now * std::sqrt(kStiff / std::max(least, 1e-6)),
               bearing = now * std::sqrt(gives_way), wanted = std::max(standing, bearing);
  return std::clamp(static_cast<int>(std::ceil(std::min(wanted, 1e6))), settings.substeps,
                    kMostTimes * settings.substeps);
}

}  // namespace truestep::rigid3d
