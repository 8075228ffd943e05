#include "engine/kernels/animation/arc_length.h"

#include <algorithm>
#include <cmath>

namespace truestep::animation {

namespace {

double gauss(const KeyCurve& curve, double a, double b) {
  constexpr double x[] = {0, 0.538469310105683, 0.906179845938664};
  constexpr double w[] = {0.568888888888889, 0.478628670499366, 0.236926885056189};
  const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
  const auto speed = [&](double t) {
    double v[3], r[3];
    curve.sample(t, v, r);
    return std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  };
  double sum = w[0] * speed(middle);
  for (int k = 1; k < 3; ++k) sum += w[k] * (speed(middle - half * x[k]) + speed(middle + half * x[k]));
  return sum * half;
}

}  // namespace

ArcLength::ArcLength(const KeyCurve& curve, size_t intervals) : start_(curve.first()) {
  const size_t n = std::max<size_t>(1, (curve.keys() - 1) * intervals);
  step_ = (curve.last() - curve.first()) / static_cast<double>(n);
  lengths_.push_back(0);
  for (size_t i = 0; i < n; ++i) {
    const double a = start_ + static_cast<double>(i) * step_;
    lengths_.push_back(lengths_.back() + gauss(curve, a, a + step_));
  }
}

double ArcLength::length(const KeyCurve& curve, double t) const {
  const double place = std::clamp((t - start_) / step_, 0.0, static_cast<double>(lengths_.size() - 1));
  const auto i = std::min(static_cast<size_t>(place), lengths_.size() - 2);
  return lengths_[i] + gauss(curve, start_ + static_cast<double>(i) * step_, t);
}

double ArcLength::time_at(const KeyCurve& curve, double length) const {
  const double s = std::clamp(length, 0.0, total());
  const auto next = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, s);
  const auto i = static_cast<size_t>(next - lengths_.begin()) - 1;
  const double a = start_ + static_cast<double>(i) * step_, way = lengths_[i + 1] - lengths_[i];
  double t = a + (way > 0 ? step_ * (s - lengths_[i]) / way : 0);
  for (int k = 0; k < 8; ++k) {
    double v[3], r[3];
    curve.sample(t, v, r);
    const double speed = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    const double off = lengths_[i] + gauss(curve, a, t) - s;
    if (!(speed > 0)) break;
    const double next_t = std::clamp(t - off / speed, a, a + step_);
    if (next_t == t) break;
    t = next_t;
  }
  return t;
}

}  // namespace truestep::animation
