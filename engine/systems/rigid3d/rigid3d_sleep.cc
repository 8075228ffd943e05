// Puts bodies to sleep (rigid/sleeping.h): slow ones that are supported by something at rest, a whole island
// at once; and how couplings see it (core/ports/body_sleep.h).
#include <algorithm>
#include <cmath>

#include "engine/rigid/islands.h"
#include "engine/rigid/sleeping.h"
#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::rigid3d {

using Part = BodyNow::Part;

namespace {

/// Target speed of a motor, as a fraction of sleep_speed, below which its bodies may sleep.
constexpr double kMotorAtRest = 0.01;
/// Rotation vector between two orientations, for small angles; rad.
Vec3 turned(const Quat& from, const Quat& to) {
  const Quat d = to * Quat{from.w, -from.x, -from.y, -from.z};
  return Vec3{d.x, d.y, d.z} * (d.w < 0 ? -2.0 : 2.0);
}

/// Position and orientation of a body relative to those in the sleep columns.
class Way {
 public:
  Way(const double* x, const double* q, double* x0, double* q0, double* middle, size_t row, double reach)
      : x_(x), q_(q), x0_(x0), q0_(q0), middle_(middle), row_(row), reach_(reach) {}
  void begin() { store3(x0_, row_, load3(x_, row_)), store_quat(q0_, row_, load_quat(q_, row_)); }
  double moved() {
    shift_ = load3(x_, row_) - load3(x0_, row_), turn_ = turned(load_quat(q0_, row_), load_quat(q_, row_));
    return norm(shift_) + reach_ * norm(turn_);
  }
  void pass() { store3(middle_, 2 * row_, shift_), store3(middle_, 2 * row_ + 1, turn_); }
  double bend() const {
    return norm(load3(middle_, 2 * row_) - 0.5 * shift_) +
           reach_ * norm(load3(middle_, 2 * row_ + 1) - 0.5 * turn_);
  }

 private:
  const double *x_, *q_;
  double *x0_, *q0_, *middle_;
  size_t row_;
  double reach_;
  Vec3 shift_, turn_;  ///< since its rest began
};

}  // namespace

void Rigid3d::update_sleeping(State& s, const StepInput& in) const {
  Scratch& scratch = Rigid3d::scratch(in);
  const auto now = scratch.contacts.bodies();
  const size_t n = now.size();
  const auto kind = s.span<uint32_t>(columns::kind);
  const auto timer = s.f64(columns::sleep_timer);
  double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data();
  // What holds a body: only contacts with friction, something else too, or only joints.
  constexpr double kRolls = 2, kHeld = 1, kHangs = 3;
  // A resting body is supported, ultimately by something that does not move. Bodies that touch while floating
  // freely drift for ever.
  scratch.parent.resize(n), scratch.rested.assign(n, 0), scratch.adrift.assign(n, 1);
  start_islands(scratch.parent);
  const auto holds = [&](uint32_t i) { return i == kNoBody || now[i].part == Part::fixed; };
  for (const Contact* c : scratch.contacts.all()) {
    const bool a = now[c->a].part == Part::active, b = now[c->b].part == Part::active;
    const bool grips = bodies_.kinds[kind[c->a]].friction * bodies_.kinds[kind[c->b]].friction > 0;
    for (const uint32_t i : {c->a, c->b}) {
      if (now[i].part == Part::active && (!grips || scratch.rested[i] == 0))
        scratch.rested[i] = grips ? kRolls : kHeld;
    }
    if (a && b) link_islands(scratch.parent, c->a, c->b);
    if (a == b || !holds(a ? c->b : c->a)) continue;
    if (std::any_of(c->impulse, c->impulse + c->manifold.count, [](double l) { return l > 0; })) {
      scratch.adrift[a ? c->a : c->b] = 0;
    }
  }
  const auto held = s.span<uint32_t>(columns::joint_bodies);
  for (size_t k = 0; k < held.size(); k += 2) {
    if (s.span<uint32_t>(columns::joint_broken)[k / 2]) continue;
    const uint32_t a = held[k], b = held[k + 1];
    for (const uint32_t i : {a, b}) {
      if (i == kNoBody || now[i].part != Part::active) continue;
      scratch.rested[i] = scratch.rested[i] == 0 || scratch.rested[i] == kHangs ? kHangs : kHeld;
    }
    if (a != kNoBody && b != kNoBody && now[a].part == Part::active && now[b].part == Part::active) {
      link_islands(scratch.parent, a, b);
    }
    if (a != kNoBody && holds(b)) scratch.adrift[a] = 0;
    if (b != kNoBody && holds(a)) scratch.adrift[b] = 0;
  }
  spread_minimum<uint8_t>(scratch.parent, scratch.adrift);
  // A running motor keeps its bodies awake even where they are blocked.
  for (size_t k = 0; k < joints_.drives.size(); ++k) {
    const Drive& d = joints_.drives[k];
    const double* motor = s.f64(columns::drive_motor).data() + 2 * k;
    if (!(d.laws & Drive::kMotor) || s.span<uint32_t>(columns::joint_broken)[d.joint]) continue;
    const double off = s.f64(columns::drive_coordinate)[k] - motor[0];
    const double speed = d.wants == Drive::Wants::speed ? motor[0] : off * d.servo_rate;
    if (!(std::abs(speed) > kMotorAtRest * sleep_speed_) || motor[1] == 0) continue;
    for (const uint32_t i : {held[2 * d.joint], held[2 * d.joint + 1]}) {
      if (i != kNoBody) scratch.rested[i] = 0;
    }
  }
  const SleepRule held_up{sleep_speed_, sleep_time_};
  const SleepRule of_rolling = held_up.of_rolling(), of_hanging = held_up.of_hanging();
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  double *x0 = s.f64(columns::sleep_position).data(), *q0 = s.f64(columns::sleep_orientation).data();
  double* middle = s.f64(columns::sleep_middle).data();
  for (size_t i = 0; i < n; ++i) {
    if (now[i].part != Part::active) continue;
    const double reach = bodies_.kinds[kind[i]].reach;
    if (bodies_.kinds[kind[i]].forced() || !bodies_.kinds[kind[i]].can_sleep) scratch.rested[i] = 0;
    const double speed = std::sqrt(norm2(load3(v, i)) + norm2(load3(w, i)) * (reach * reach));
    const bool may_rest = scratch.rested[i] > 0 && (!scratch.adrift[i] || speed == 0);
    const SleepRule& rule = scratch.rested[i] == kRolls   ? of_rolling
                            : scratch.rested[i] == kHangs ? of_hanging
                                                          : held_up;
    count_rest(timer[i], in.h, may_rest ? speed : kNoRest, rule, Way{x, q, x0, q0, middle, i, reach});
    scratch.rested[i] = timer[i];
  }
  spread_minimum<double>(scratch.parent, scratch.rested);
  for (size_t i = 0; i < n; ++i) {
    if (now[i].part != Part::active || scratch.rested[i] == 0 || scratch.rested[i] < sleep_time_) continue;
    s.span<uint32_t>(columns::asleep)[i] = 1;
    store3(v, i, Vec3{}), store3(w, i, Vec3{});
  }
}

bool Rigid3d::asleep(const State& s, size_t row) const {
  return s.span<uint32_t>(columns::asleep)[row] != 0;
}

double Rigid3d::sleep_timer(const State& s, size_t row) const {
  return s.f64(columns::sleep_timer)[row];
}

void Rigid3d::set_sleep_timer(State& s, size_t row, double seconds) const {
  s.f64(columns::sleep_timer)[row] = seconds;
}

void Rigid3d::lead(State& s, size_t row, const Vec3& rate, const Vec3& spin_rate) const {
  s.f64(columns::sleep_timer)[row] = kLed;
  double* rates = s.f64(columns::sleep_middle).data();
  store3(rates, 2 * row, rate), store3(rates, 2 * row + 1, spin_rate);
}

}  // namespace truestep::rigid3d
