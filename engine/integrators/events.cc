#include "engine/integrators/events.h"

#include <algorithm>
#include <cmath>

namespace truestep {

double bracketed_root(const std::function<double(double)>& f, double a, double fa, double b, double fb,
                      double tolerance) {
  if (fa == 0) return a;
  if (fb == 0) return b;
  // (b, fb) is the newest point, (a, fa) the other end of the bracket, (c, fc) the one before.
  double c = a, fc = fa, share = 0.5;
  for (int i = 0; i < 200; ++i) {
    const double x = a + share * (b - a), fx = f(x);
    if (std::signbit(fx) == std::signbit(fa)) {
      c = a, fc = fa;
    } else {
      c = b, fc = fb, b = a, fb = fa;
    }
    a = x, fa = fx;
    const double best = std::abs(fa) < std::abs(fb) ? a : b;
    const double width = std::abs(b - a), limit = (2 * 2.3e-16 * std::abs(best) + 0.5 * tolerance) / width;
    if (fx == 0 || limit > 0.5) return fx == 0 ? x : best;
    // Inverse quadratic interpolation where it is monotonous between the three points, else bisection.
    const double xi = (a - b) / (c - b), phi = (fa - fb) / (fc - fb);
    share = 0.5;
    if (phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi) {
      share = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb);
    }
    share = std::clamp(share, limit, 1 - limit);
  }
  return std::abs(fa) < std::abs(fb) ? a : b;
}

EventWatcher::EventWatcher(std::span<const Event> events, size_t n, StepWatcher* next)
    : events_(events), next_(next), y_(n), last_(events.size(), 0.0) {}

void EventWatcher::start(double t, const double* y) {
  stopped_by_.reset();
  for (size_t e = 0; e < events_.size(); ++e) last_[e] = events_[e].g(t, y);
}

StepWatcher::Verdict EventWatcher::accepted(double t0, double& t1, double* y1, const Interpolant& between) {
  const double length = t1 - t0;
  const auto value = [&](const Event& e, double theta) {
    if (theta == 1) return e.g(t1, y1);
    between.at(theta, y_.data());
    return e.g(t0 + theta * length, y_.data());
  };
  // Crossings as event and share of the step.
  found_.clear();
  for (size_t e = 0; e < events_.size(); ++e) {
    double before = last_[e];
    for (int part = 1; part <= kParts; ++part) {
      const double to = double(part) / kParts, now = value(events_[e], to);
      double from = double(part - 1) / kParts;
      // On which side a zero is left tells a place a little further on.
      if (before == 0) from += 1e-6 / kParts, before = value(events_[e], from);
      const bool rising = before < 0 && now >= 0, falling = before > 0 && now <= 0;
      const auto wanted = events_[e].direction;
      if ((rising && wanted != Event::Direction::falling) ||
          (falling && wanted != Event::Direction::rising)) {
        const double resolution = 4e-16 * std::max(std::abs(t0), std::abs(t1)) / length;
        found_.push_back({e, bracketed_root([&](double theta) { return value(events_[e], theta); }, from,
                                            before, to, now, std::max(resolution, 2e-16))});
      }
      before = now;
    }
    last_[e] = before;
  }
  std::sort(found_.begin(), found_.end(), [](const Hit& a, const Hit& b) { return a.t < b.t; });
  auto verdict = Verdict::go_on;
  for (const Hit& hit : found_) {
    const bool at_end = hit.t == 1;
    hits_.push_back({hit.event, at_end ? t1 : t0 + hit.t * length});
    if (events_[hit.event].then != Event::Then::stop) continue;
    if (!at_end) {
      between.at(hit.t, y_.data());
      std::copy(y_.begin(), y_.end(), y1);
      t1 = hits_.back().t;
    }
    stopped_by_ = hit.event;
    verdict = Verdict::stop;
    break;
  }
  if (next_ && next_->accepted(t0, t1, y1, between) == Verdict::stop) verdict = Verdict::stop;
  return verdict;
}

}  // namespace truestep
