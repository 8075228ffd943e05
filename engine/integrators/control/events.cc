#include "engine/integrators/control/events.h"

namespace truestep {

namespace {
int32_t side(double g) {
  return g > 0 ? 1 : g < 0 ? -1 : 0;
}
}  // namespace

EventWatcher::EventWatcher(Guards& guards, std::span<const Crossing> directions, size_t n)
    : guards_(guards),
      directions_(directions),
      now_(directions.size()),
      before_(directions.size()),
      ahead_(directions.size()),
      point_(n) {
  fired_.reserve(directions.size());
  fired_side_.reserve(directions.size());
}

bool EventWatcher::crosses(size_t k) const {
  if (sides_[k] == 0 || side(now_[k]) == sides_[k]) return false;
  return directions_[k] == Crossing::either ||
         (directions_[k] == Crossing::rising ? sides_[k] < 0 : sides_[k] > 0);
}
bool EventWatcher::any_crosses() const {
  for (size_t k = 0; k < now_.size(); ++k) {
    if (crosses(k)) return true;
  }
  return false;
}
void EventWatcher::keep_sides() {
  for (size_t k = 0; k < now_.size(); ++k) sides_[k] = side(now_[k]);
}

void EventWatcher::look(double t, const double* y) {
  guards_.evaluate(t, y, now_.data());
  keep_sides();
  for (size_t i = 0; i < fired_.size(); ++i) {
    if (sides_[fired_[i]] == fired_side_[i]) sides_[fired_[i]] = 0;
  }
}

// Fraction of the step at which the first of the guards that have changed sides at `high` crosses.
double EventWatcher::earliest(double t0, double h, double low, double high, const Interpolant& between) {
  const auto evaluate = [&](double theta, std::vector<double>& g) {
    between.at(theta, point_.data());
    guards_.evaluate(t0 + theta * h, point_.data(), g.data());
  };
  evaluate(low, before_);
  ahead_ = now_;
  double first = high;
  for (size_t k = 0; k < ahead_.size(); ++k) {
    now_[k] = ahead_[k];
    if (!crosses(k)) continue;
    // Rounding may already show the start on the other side: then only its sign is known.
    const double start = side(before_[k]) == sides_[k] ? before_[k] : sides_[k] * std::abs(ahead_[k]);
    const double root = bracketed_root(
        [&](double theta) {
          evaluate(theta, now_);
          return now_[k];
        },
        low, start, high, ahead_[k], 1e-16 * std::abs(t0 + h) / h);
    first = std::min(first, root);
  }
  return first;
}

StepWatcher::Verdict EventWatcher::accepted(double t0, double& t1, double* y1, const Interpolant& between) {
  const double h = t1 - t0;
  double low = 0;
  // The side on which a guard leaves zero is determined slightly further on.
  constexpr double kLittle = 1e-6;
  if (std::ranges::find(sides_, 0) != sides_.end()) {
    between.at(kLittle, point_.data());
    guards_.evaluate(t0 + kLittle * h, point_.data(), now_.data());
    for (size_t k = 0; k < now_.size(); ++k) {
      if (sides_[k] == 0) sides_[k] = side(now_[k]);
    }
    low = kLittle;
  }
  for (const double theta : {0.25, 0.5, 0.75, 1.0}) {
    const double* y = y1;
    if (theta < 1) {
      between.at(theta, point_.data());
      y = point_.data();
    }
    guards_.evaluate(t0 + theta * h, y, now_.data());
    if (!any_crosses()) {
      keep_sides();
      low = theta;
      continue;
    }
    const double first = earliest(t0, h, low, theta, between);
    if (first < 1) {
      between.at(first, point_.data());
      t1 = t0 + first * h;
      std::copy(point_.begin(), point_.end(), y1);
    }
    guards_.evaluate(t1, y1, now_.data());
    for (size_t k = 0; k < now_.size(); ++k) {
      if (!crosses(k)) continue;
      fired_.push_back(static_cast<uint32_t>(k));
      fired_side_.push_back(side(now_[k]));
    }
    // The point has crossed by construction; its time may have shifted by rounding.
    return fired_.empty() ? Verdict::go_on : Verdict::stop;
  }
  return Verdict::go_on;
}

}  // namespace truestep
