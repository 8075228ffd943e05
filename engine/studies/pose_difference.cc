#include "engine/studies/pose_difference.h"

#include <algorithm>
#include <cmath>

namespace truestep {

namespace json = boost::json;

namespace {

/// Angle of the rotation from one quaternion to the other.
double angle_between(const double* p, const double* q) {
  // |p - q| and |p + q| of unit quaternions at half angle a: 2 sin(a / 2) and 2 cos(a / 2) for one sign.
  double less = 0, more = 0;
  for (int k = 0; k < 4; ++k) less += (p[k] - q[k]) * (p[k] - q[k]), more += (p[k] + q[k]) * (p[k] + q[k]);
  return 4 * std::atan2(std::sqrt(std::min(less, more)), std::sqrt(std::max(less, more)));
}

}  // namespace

RigidKind rigid_kind(const State& s) {
  const auto has = [&](const char* name, uint32_t width) {
    const auto c = s.find(name);
    return c && s.info(*c).role == Role::position && s.info(*c).width == width;
  };
  if (!has("position", 3)) return RigidKind::none;
  return has("orientation", 4) ? RigidKind::space : has("angle", 1) ? RigidKind::plane : RigidKind::none;
}

void PoseDifference::take_larger(const PoseDifference& d) {
  position_rms = std::max(position_rms, d.position_rms);
  position_largest = std::max(position_largest, d.position_largest);
  angle_rms = std::max(angle_rms, d.angle_rms);
  angle_largest = std::max(angle_largest, d.angle_largest);
}

PoseDifference pose_difference(RigidKind kind, const std::vector<std::vector<double>>& runs_a,
                               const std::vector<std::vector<double>>& runs_b, size_t i) {
  const size_t width = kind == RigidKind::space ? 4 : 1;
  const std::vector<double>&a = runs_a[i], &b = runs_b[i], &start = runs_a[0];
  PoseDifference d;
  if (kind == RigidKind::none || a.size() != b.size() || a.size() != start.size()) return d;
  const size_t n = a.size() / (3 + width);
  double moving = 0;
  for (size_t k = 0; k < n; ++k) {
    const size_t x = 3 * k, q = 3 * n + width * k;
    const auto still = [&](const std::vector<double>& now) {
      return std::equal(now.begin() + static_cast<ptrdiff_t>(x), now.begin() + static_cast<ptrdiff_t>(x + 3),
                        start.begin() + static_cast<ptrdiff_t>(x)) &&
             std::equal(now.begin() + static_cast<ptrdiff_t>(q),
                        now.begin() + static_cast<ptrdiff_t>(q + width),
                        start.begin() + static_cast<ptrdiff_t>(q));
    };
    if (still(a) && still(b)) continue;
    const double away = std::hypot(a[x] - b[x], a[x + 1] - b[x + 1], a[x + 2] - b[x + 2]);
    const double turn = kind == RigidKind::space ? angle_between(&a[q], &b[q]) : std::abs(a[q] - b[q]);
    d.position_rms += away * away, d.angle_rms += turn * turn;
    d.position_largest = std::max(d.position_largest, away);
    d.angle_largest = std::max(d.angle_largest, turn);
    ++moving;
  }
  if (moving > 0)
    d.position_rms = std::sqrt(d.position_rms / moving), d.angle_rms = std::sqrt(d.angle_rms / moving);
  return d;
}

json::object describe(const PoseDifference& d) {
  const auto number = [](double x) { return std::isfinite(x) ? json::value(x) : json::value(nullptr); };
  return {{"position_rms", number(d.position_rms)},
          {"position_largest", number(d.position_largest)},
          {"angle_rms", number(d.angle_rms)},
          {"angle_largest", number(d.angle_largest)}};
}

}  // namespace truestep
