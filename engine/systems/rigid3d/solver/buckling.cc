#include "engine/systems/rigid3d/solver/buckling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/rigid/islands.h"

namespace truestep::rigid3d {

namespace {

/// Minimum number of bodies on a contact for buckling: half of what five substeps can hold.
constexpr double kTallLoad = 10;
/// Below the first quotient substeps are added until it reaches the second; above the third fewer are tried.
constexpr double kTooSoft = 1.1, kStiff = 1.4, kMoreThanStiff = 2.2;
/// Tilt stiffness of four points, each with the stiffness of its own reduced mass, relative to one spring for
/// the tilt: for the whole face of a cube; half a face has more.
constexpr double kPoints = 1.5;
/// A contact under such loads may yield by this fraction of the smaller body's reach.
constexpr double kMostGive = 0.015;
/// m/s; faster bodies are falling or in flight.
constexpr double kStands = 0.5;

/// integral_0^s of (t (2 - t))^2.
double squared_tilts(double s) {
  return s * s * s * (4.0 / 3 - s + 0.2 * s * s);
}

}  // namespace

int BucklingWatch::substeps(const State& s, std::span<const BodyKind> kinds, const SolverSettings& settings,
                            int now, double h) {
  const auto kind = s.span<uint32_t>(columns::kind);
  const auto asleep = s.span<uint32_t>(columns::asleep);
  const auto bodies = s.span<uint32_t>(columns::contact_bodies), ids = s.span<uint32_t>(columns::contact_ids);
  const double *impulse = s.f64(columns::contact_impulse).data(), *x = s.f64(columns::position).data(),
               *v = s.f64(columns::velocity).data();
  const Vec3 gravity = load3(s.f64(columns::gravity).data(), 0);
  const double g = norm(gravity), substep = s.f64(columns::substep)[0];
  const size_t contacts = s.rows(columns::contact_bodies);
  if (!(g > 0) || !(substep > 0)) return settings.substeps;

  const auto moves = [&](uint32_t i) { return kinds[kind[i]].moved_by_forces() && !asleep[i]; };
  const auto load = [&](size_t k) {
    return (impulse[4 * k] + impulse[4 * k + 1] + impulse[4 * k + 2] + impulse[4 * k + 3]) / substep;
  };
  const auto offset = s.f64(columns::contact_offset);
  bool tall = false;
  double gives_way = 0;  // yield, as a fraction of the allowed yield
  for (size_t k = 0; k < contacts; ++k) {
    double lightest = std::numeric_limits<double>::max(), smallest = lightest;
    bool stands = true;
    for (const uint32_t i : {bodies[2 * k], bodies[2 * k + 1]}) {
      if (!moves(i)) continue;
      stands &= norm2(load3(v, i)) < kStands * kStands;
      lightest = std::min(lightest, kinds[kind[i]].mass), smallest = std::min(smallest, kinds[kind[i]].reach);
    }
    if (!(load(k) > kTallLoad * lightest * g)) continue;
    tall = true;
    if (stands) gives_way = std::max(gives_way, offset[k] / (kMostGive * smallest));
  }
  if (!tall) return settings.substeps;

  const Vec3 up = gravity * (-1 / g);
  const auto height = [&](uint32_t i) { return dot(load3(x, i), up); };
  parent_.resize(kind.size()), start_islands(parent_);
  for (size_t k = 0; k < contacts; ++k) {
    const uint32_t a = bodies[2 * k], b = bodies[2 * k + 1];
    if (moves(a) && moves(b)) link_islands(parent_, a, b);
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
  for (uint32_t i = 0; i < kind.size(); ++i) {
    if (!moves(i)) continue;
    Island& all = island_[island_of(parent_, i)];
    all.counts &= norm2(load3(v, i)) < kStands * kStands;
    all.load += kinds[kind[i]].mass * g * (all.high - all.low) * squared_tilts(place(all, height(i)));
  }
  const double rate = contact_rate(settings, h / now), w2 = rate * rate;
  for (size_t k = 0; k < contacts; ++k) {
    const uint32_t a = bodies[2 * k], b = bodies[2 * k + 1];
    if (!moves(a) && !moves(b)) continue;
    Island& all = island_[island_of(parent_, moves(a) ? a : b)];
    if (ids[5 * k] < 3 && load(k) > 0) all.counts = false;
    double turns = 0, tilt[2] = {};
    int end = 0;
    for (const uint32_t i : {a, b}) {
      if (moves(i)) {
        const Vec3& I = kinds[kind[i]].moments;
        const double t = place(all, height(i));
        turns += 1 / std::min({I.x, I.y, I.z}), tilt[end] = t * (2 - t);
      }
      ++end;
    }
    const double turn = tilt[1] - tilt[0];
    if (load(k) > 0) all.stiffness += kPoints * w2 / turns * turn * turn;
  }
  double least = kMoreThanStiff;
  for (uint32_t i = 0; i < kind.size(); ++i) {
    const Island& all = island_[i];
    if (all.counts && all.load > 0) least = std::min(least, all.stiffness / all.load);
  }
  const bool enough = least >= kTooSoft && (now == settings.substeps || least < kMoreThanStiff);
  const double standing = enough ? now : now * std::sqrt(kStiff / std::max(least, 1e-6)),
               bearing = now * std::sqrt(gives_way), wanted = std::max(standing, bearing);
  return std::clamp(static_cast<int>(std::ceil(std::min(wanted, 1e6))), settings.substeps,
                    kMostTimes * settings.substeps);
}

}  // namespace truestep::rigid3d
