#include "engine/kernels/animation/rotations.h"

#include <algorithm>

namespace truestep::animation {

using free_rotation::rotation_vector;
using free_rotation::turn;

Quat slerp(const Quat& a, const Quat& b, double s) {
  return normalized(a * turn(rotation_vector(conjugate(a) * nearer(a, b)) * s));
}

Quat squad_point(const Quat& before, const Quat& q, const Quat& after) {
  const Quat back = conjugate(q);
  return normalized(
      q *
      turn((rotation_vector(back * nearer(q, after)) + rotation_vector(back * nearer(q, before))) * -0.25));
}

Quat squad(const Quat& q0, const Quat& s0, const Quat& s1, const Quat& q1, double u) {
  return slerp(slerp(q0, q1, u), slerp(s0, s1, u), 2 * u * (1 - u));
}

SwingTwist swing_twist(const Quat& q, const Vec3& axis) {
  const double along = q.x * axis.x + q.y * axis.y + q.z * axis.z;
  // A swing of half a turn leaves no well-defined twist.
  if (q.w * q.w + along * along < 1e-24) return {q, 0};
  const Quat twist = normalized(Quat{q.w, axis.x * along, axis.y * along, axis.z * along});
  const double side = q.w < 0 ? -1 : 1;
  return {normalized(q * conjugate(twist)), 2 * trig::atan2(side * along, side * q.w)};
}

RotationCurve::RotationCurve(std::span<const double> times, std::span<const Quat> keys, Turning turning,
                             Extend extend)
    : times_(times.begin(), times.end()),
      keys_(keys.begin(), keys.end()),
      turning_(turning),
      extend_(extend) {
  const size_t n = keys_.size();
  for (size_t i = 0; i < n; ++i) keys_[i] = normalized(keys_[i]);
  for (size_t i = 1; i < n; ++i) keys_[i] = nearer(keys_[i - 1], keys_[i]);
  if (turning_ != Turning::squad) return;
  const bool closed =
      extend_ == Extend::loop && n > 2 && norm(rotation_vector(conjugate(keys_[0]) * keys_[n - 1])) < 1e-12;
  for (size_t i = 0; i < n; ++i) {
    const size_t before = i > 0 ? i - 1 : closed ? n - 2 : 0, after = i + 1 < n ? i + 1 : closed ? 1 : n - 1;
    inner_.push_back(squad_point(keys_[before], keys_[i], keys_[after]));
  }
}

Quat RotationCurve::sample(double at) const {
  const double t = within(at, times_.front(), times_.back(), extend_).t;
  if (times_.size() < 2 || (turning_ == Turning::step && t >= times_.back())) return keys_.back();
  const auto next = std::upper_bound(times_.begin() + 1, times_.end() - 1, t);
  const auto i = static_cast<size_t>(next - times_.begin()) - 1;
  const double u = (t - times_[i]) / (times_[i + 1] - times_[i]);
  switch (turning_) {
    case Turning::step:
      return keys_[i];
    case Turning::nlerp:
      return nlerp(keys_[i], keys_[i + 1], u);
    case Turning::slerp:
      return slerp(keys_[i], keys_[i + 1], u);
    case Turning::squad:
      break;
  }
  return squad(keys_[i], inner_[i], inner_[i + 1], keys_[i + 1], u);
}

}  // namespace truestep::animation
