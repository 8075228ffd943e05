#include "engine/systems/rigid2d/solver/substeps.h"

#include <algorithm>
#include <cmath>

#include "engine/rigid/islands.h"

namespace truestep::rigid2d {
namespace {

/// Columns buckle only where a contact carries more bodies than this.
constexpr double kTallLoad = 10;
/// Below the first quotient substeps are added until it reaches the second; above the third, fewer are
/// tried.
constexpr double kTooSoft = 1.1, kStiff = 1.4, kMoreThanStiff = 2.2;
/// Load of a light body, in multiples of its own weight, up to which the usual substeps suffice.
constexpr double kEasyBurden = 3;
/// An approach speed counts as an impact above this many substeps of free fall.
constexpr double kHits = 30;

/// integral_0^s of (t (2 - t))^2.
double squared_tilts(double s) {
  return s * s * s * (4.0 / 3 - s + 0.2 * s * s);
}

double gravity_of(const State& s) {
  const auto g = s.f64(columns::parameters);
  return std::sqrt(g[0] * g[0] + g[1] * g[1]);
}

/// A body held by a joint, such as a drum on its axle, does not rest on another and supports like the ground.
bool moves(const Model& model, std::span<const uint32_t> status, uint32_t i) {
  return i < model.count() && is_moved(model.light[i], status[i]) && !model.light[i].hung;
}

}  // namespace

void Substeps::find_islands(const Model& model, const State& s, const Pairs& pairs) {
  const auto status = s.span<uint32_t>(columns::status);
  const auto g = s.f64(columns::parameters);
  const double *x = s.f64(columns::position).data(), weight = gravity_of(s);
  parent_.resize(model.count()), start_islands(parent_);
  for (const uint32_t k : pairs.touching) {
    const uint32_t a = pairs.hits[k].body_a, b = pairs.hits[k].body_b;
    if (moves(model, status, a) && moves(model, status, b)) link_islands(parent_, a, b);
  }
  island_.assign(model.count(), {HUGE_VAL, -HUGE_VAL});
  for (uint32_t i = 0; i < model.count(); ++i) {
    if (!moves(model, status, i)) continue;
    Island& all = island_[island_of(parent_, i)];
    const double height = -(g[0] * x[3 * i] + g[1] * x[3 * i + 1]) / weight;
    all.low = std::min(all.low, height), all.high = std::max(all.high, height), ++all.bodies;
    all.heaviest = std::max(all.heaviest, model.light[i].mass);
    all.lightest = std::min(all.lightest, model.light[i].mass);
  }
}

double Substeps::largest_burden(const Model& model, const State& s, const Pairs& pairs, double h) {
  const auto keys = s.span<uint64_t>(columns::contact_key);
  const auto status = s.span<uint32_t>(columns::status);
  const auto impulse = s.span<float>(columns::contact_impulse);
  const double weight = gravity_of(s);
  double most = 1;
  for (size_t k = 0; k < keys.size(); ++k) {
    const double load = (impulse[5 * k] + impulse[5 * k + 1]) / h;
    for (const uint32_t i : {model.body_of[keys[k] >> 32], model.body_of[static_cast<uint32_t>(keys[k])]}) {
      if (!moves(model, status, i)) continue;
      const double mass = model.light[i].mass;
      most = std::max(most, std::min(load / (mass * weight), island_[island_of(parent_, i)].heaviest / mass));
    }
  }
  const double* v = s.f64(columns::velocity).data();
  // No load is known at the start. Contacts that were made stiffer under it would throw up what they bear.
  const auto* g = s.f64(columns::parameters).data();
  const double* x = s.f64(columns::position).data();
  const auto bears_heavier = [&](uint32_t a, uint32_t b) {
    if (!moves(model, status, a) || !moves(model, status, b)) return false;
    const double rise = g[0] * (x[3 * a] - x[3 * b]) + g[1] * (x[3 * a + 1] - x[3 * b + 1]);
    return (rise > 0 ? model.light[b].mass - model.light[a].mass
                     : model.light[a].mass - model.light[b].mass) > 0;
  };
  for (const uint32_t k : pairs.touching) {
    const uint32_t a = pairs.hits[k].body_a, b = pairs.hits[k].body_b;
    const Vec2 closing{v[3 * a] - v[3 * b], v[3 * a + 1] - v[3 * b + 1]};
    const uint32_t mover = moves(model, status, a) ? a : b;
    if (!moves(model, status, mover)) continue;
    if (!(keys.empty() && bears_heavier(a, b)) &&
        flat::dot(closing, pairs.contacts[k].normal) < kHits * weight * h)
      continue;
    const Island& all = island_[island_of(parent_, mover)];
    most = std::max(most, all.heaviest / all.lightest);
  }
  return most;
}

double Substeps::least_quotient(const Model& model, const State& s, double rate) {
  const auto keys = s.span<uint64_t>(columns::contact_key);
  const auto ids = s.span<uint32_t>(columns::contact_id), status = s.span<uint32_t>(columns::status);
  const auto impulse = s.span<float>(columns::contact_impulse);
  const auto g = s.f64(columns::parameters);
  const double *x = s.f64(columns::position).data(), weight = gravity_of(s);
  const auto place = [&](const Island& all, uint32_t i) {
    const double height = -(g[0] * x[3 * i] + g[1] * x[3 * i + 1]) / weight;
    return std::clamp((height - all.low) / std::max(all.high - all.low, 1e-9), 0.0, 1.0);
  };
  for (uint32_t i = 0; i < model.count(); ++i) {
    if (!moves(model, status, i)) continue;
    Island& all = island_[island_of(parent_, i)];
    all.load += model.light[i].mass * weight * (all.high - all.low) * squared_tilts(place(all, i));
  }
  for (size_t k = 0; k < keys.size(); ++k) {
    const uint32_t ends[] = {model.body_of[keys[k] >> 32], model.body_of[static_cast<uint32_t>(keys[k])]};
    const bool moved[] = {moves(model, status, ends[0]), moves(model, status, ends[1])};
    if (!(impulse[5 * k] + impulse[5 * k + 1] > 0) || (!moved[0] && !moved[1])) continue;
    Island& all = island_[island_of(parent_, ends[moved[0] ? 0 : 1])];
    if (!moved[0] || !moved[1]) all.stands = true;
    // A corner on a face does not resist tilting.
    all.bearings += ids[2 * k + 1] == kNoPoint ? all.bodies + 1 : 1;
    double turns = 0, tilt[2] = {};
    for (int e = 0; e < 2; ++e) {
      if (!moved[e]) continue;
      const double t = place(all, ends[e]);
      turns += model.dynamics[ends[e]].inverse_inertia, tilt[e] = t * (2 - t);
    }
    if (turns > 0) all.stiffness += rate * rate / turns * (tilt[1] - tilt[0]) * (tilt[1] - tilt[0]);
  }
  double least = HUGE_VAL;
  for (const Island& all : island_) {
    if (all.stands && all.bearings == all.bodies) least = std::min(least, all.stiffness / all.load);
  }
  return least;
}

int Substeps::wanted(const Model& model, const State& s, const Pairs& pairs, const Usual& usual) {
  const double weight = gravity_of(s);
  uneven_ = false;
  if (!(weight > 0)) return usual.least;
  const auto keys = s.span<uint64_t>(columns::contact_key);
  const auto status = s.span<uint32_t>(columns::status);
  const auto impulse = s.span<float>(columns::contact_impulse);
  bool tall = false;
  for (size_t k = 0; k < keys.size() && !tall && usual.looks && usual.rate > 0; ++k) {
    double heavier = HUGE_VAL;
    for (const uint32_t i : {model.body_of[keys[k] >> 32], model.body_of[static_cast<uint32_t>(keys[k])]}) {
      if (!moves(model, status, i)) continue;
      heavier = std::max(heavier < HUGE_VAL ? heavier : 0, model.light[i].mass);
    }
    tall = (impulse[5 * k] + impulse[5 * k + 1]) / usual.h > kTallLoad * heavier * weight;
  }
  double lightest = HUGE_VAL, heaviest = 0;
  for (const uint32_t k : pairs.touching) {
    for (const uint32_t i : {pairs.hits[k].body_a, pairs.hits[k].body_b}) {
      if (!moves(model, status, i)) continue;
      lightest = std::min(lightest, model.light[i].mass);
      heaviest = std::max(heaviest, model.light[i].mass);
    }
  }
  uneven_ = heaviest > kEasyBurden * lightest;
  if (!uneven_ && !tall) return usual.least;
  find_islands(model, s, pairs);
  double more = usual.least;
  if (uneven_) more *= std::sqrt(largest_burden(model, s, pairs, usual.h) / kEasyBurden);
  if (tall) {
    const double quotient = least_quotient(model, s, usual.rate);
    const bool holds = quotient >= kTooSoft && (usual.now == usual.least || quotient < kMoreThanStiff);
    more = std::max(more, holds ? usual.now : usual.now * std::sqrt(kStiff / std::max(quotient, 1e-6)));
  }
  return std::clamp(static_cast<int>(std::ceil(std::min(more, 1e6))), usual.least,
                    Substeps::kMostTimes * usual.least);
}

}  // namespace truestep::rigid2d
