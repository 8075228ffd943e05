#include "engine/systems/nbody/collisions/meetings.h"

#include <algorithm>
#include <cmath>

#include "engine/systems/nbody/collisions/collisions.h"
#include "engine/systems/nbody/collisions/impacts.h"
#include "engine/systems/nbody/collisions/touches.h"

namespace truestep::nbody {

namespace {

constexpr double kShortFlight = 1.0 / 64;  // of the step
constexpr int kSweeps = 1000;              // of impulses at one moment

Vec3 from_a_to_b(const double* column, uint32_t a, uint32_t b) {
  return load3(column, b) - load3(column, a);
}

}  // namespace

Meetings::Meetings(const CollisionsDef& def, State& s, const StepInput& in, bool fixed, Memory& memory)
    : def_(def), balls_(s), in_(in), fixed_(fixed), w_(memory) {
  w_.met.clear();
  if (def.response != Response::merge) w_.first.assign(balls_.x(), balls_.x() + 3 * balls_.count());
}

void Meetings::resolve(double now, Pair hit, bool blunt) {
  hit_ = hit;
  gather();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool any = false;
    for (size_t k = 0; k < w_.near.size(); ++k) {
      const Pair pair = w_.near[k];
      if (w_.met.resting(pair.a, pair.b) || !meet(pair, now, blunt)) continue;
      any = true;
      // The rows have changed.
      if (def_.response == Response::merge) {
        gather();
        break;
      }
    }
    if (!any) return;
  }
  ++impact(balls_.state(), Impact::left_over);
}

void Meetings::gather() {
  w_.near.clear();
  const size_t n = balls_.count();
  const double* const x = balls_.x();
  const auto touching = [&](uint32_t a, uint32_t b) {
    const double r = balls_.reach(a, b) * (1 + 10 * kTouching);
    if (r > 0 && norm2(from_a_to_b(x, a, b)) <= r * r) w_.near.push_back({a, b});
  };
  if (n <= kEveryPair) {
    for (uint32_t a = 0; a < n; ++a) {
      for (uint32_t b = a + 1; b < n; ++b) touching(a, b);
    }
    return;
  }
  // Standing still: every ball that another one overlaps.
  w_.still.assign(3 * n, 0.0);
  const PathPiece still{x, w_.still.data(), x, w_.still.data(), n, 1};
  for_near_pairs(still, balls_.radii(), kTouching, in_.workspace, touching);
}

void Meetings::join(Pair pair) {
  State& s = balls_.state();
  ++counter(s, Counter::collisions), ++counter(s, Counter::merged);
  const bool first = balls_.mass(pair.a) >= balls_.mass(pair.b);
  const uint32_t stays = first ? pair.a : pair.b, gone = first ? pair.b : pair.a;
  merge(s, stays, gone);
  w_.dead.assign(balls_.count(), 0), w_.dead[gone] = 1;
  remove_rows(s, w_.dead);
  w_.met.clear();  // it names rows
}

/// Closing speed (m/s) below which a pair rests: what draws it together in half a short flight. Of its
/// attraction that is what does not go into turning round each other: a pair that grazes faster than that
/// flies on.
double Meetings::least_speed(Pair pair) const {
  const auto speed = [&](uint32_t i) { return norm(load3(balls_.v(), i)); };
  const double r = balls_.reach(pair.a, pair.b), masses = balls_.mass(pair.a) + balls_.mass(pair.b);
  const Vec3 u = from_a_to_b(balls_.v(), pair.a, pair.b),
             n = normalized(from_a_to_b(balls_.x(), pair.a, pair.b));
  const double along = dot(u, n), turning = (norm2(u) - along * along) / r;
  const double draws = std::max(0.0, balls_.gravitational_constant() * masses / (r * r) - turning);
  return std::max(1e-13 * (speed(pair.a) + speed(pair.b)), 0.5 * kShortFlight * in_.h * draws);
}

/// False when they part already.
bool Meetings::meet(Pair pair, double now, bool blunt) {
  const auto [a, b] = pair;
  const Vec3 u = from_a_to_b(balls_.v(), a, b), n = normalized(from_a_to_b(balls_.x(), a, b));
  const double closing = -dot(u, n);
  // Those that lean on each other are found with no speed.
  if (!(closing > 0) && hit_ != pair) return false;
  hit_ = {};
  if (def_.response == Response::merge) {
    join(pair);
    return true;
  }
  MetPair& met = w_.met.of(a, b);
  const double least = least_speed(pair);
  const bool back = met.when >= 0 && now - met.when < kShortFlight * in_.h && closing <= 2 * met.parted;
  const bool rests = blunt || closing <= least || back;
  const double r = balls_.reach(a, b), masses = balls_.mass(a) + balls_.mass(b);
  if (!rests) ++counter(balls_.state(), Counter::collisions);
  if (!rests && fixed_ && masses > 0) {
    double& worst = impact(balls_.state(), Impact::largest_ratio);
    worst = std::max(worst, in_.h * std::sqrt(balls_.gravitational_constant() * masses / (r * r * r)));
  }
  const Vec3 change = change_of_velocity(u, n, def_.response, rests ? 0 : def_.restitution);
  const double to_a = share_of_first(balls_.mass(a), balls_.mass(b));
  push_apart(balls_.v(), pair, change);
  if (!rests) stir(a, change * -to_a, least), stir(b, change * (1 - to_a), least);
  met.when = now, met.resting = rests;
  met.parted = std::max(0.0, dot(u + change, n));
  // With no speed to part at, the next thing they do is to lean on each other.
  if (met.parted == 0) met.resting = true;
  return true;
}

/// Body i has been hit: what it leaned on is hit in turn if it is pushed at it faster than it was pulled.
void Meetings::stir(uint32_t i, const Vec3& change, double least) {
  for (MetPair& p : w_.met.all()) {
    if (!p.resting || (p.a != i && p.b != i)) continue;
    const Vec3 n = normalized(from_a_to_b(balls_.x(), p.a, p.b));
    const double now = -dot(from_a_to_b(balls_.v(), p.a, p.b), n);
    const double more = dot(change, n) * (p.a == i ? 1 : -1);
    if (more > std::max(now - more, least)) p.resting = false;
  }
}

void Meetings::push_apart(double* column, Pair pair, const Vec3& change) {
  const auto [a, b] = pair;
  const double to_a = share_of_first(balls_.mass(a), balls_.mass(b));
  store3(column, a, load3(column, a) - change * to_a);
  store3(column, b, load3(column, b) + change * (1 - to_a));
}

double Meetings::apart_at_start(Pair pair) const {
  return norm(from_a_to_b(w_.first.data(), pair.a, pair.b));
}

void Meetings::hold() {
  if (def_.response == Response::merge) return;
  constexpr int kRounds = 20;
  for (int round = 0; round < kRounds; ++round) {
    bool any = false;
    for (const MetPair& p : w_.met.all()) {
      const Pair pair{p.a, p.b};
      const Vec3 d = from_a_to_b(balls_.x(), p.a, p.b), n = normalized(d),
                 u = from_a_to_b(balls_.v(), p.a, p.b);
      const double least = std::min(balls_.reach(p.a, p.b), apart_at_start(pair)), missing = least - norm(d);
      if (missing > 1e-15 * least) push_apart(balls_.x(), pair, n * missing), any = true;
      if (p.resting && dot(u, n) < 0) {
        push_apart(balls_.v(), pair, change_of_velocity(u, n, def_.response, 0)), any = true;
      }
    }
    if (!any) return;
  }
}

}  // namespace truestep::nbody
