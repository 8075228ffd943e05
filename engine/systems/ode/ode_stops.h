// When the right-hand side jumps next, for comparisons of time (OdeModel::Stop). Those of s0 + s1 t are
// solved for, also where floors and other jumps of time shift them (each a stop of its own); any other
// function of time is sampled 64 times a step and its changes of sign are bisected.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/integrators/control/events.h"
#include "engine/systems/ode/ode_equations.h"

namespace truestep::ode {

class OdeStops {
 public:
  /// The model must outlive this.
  explicit OdeStops(const OdeModel& model)
      : model_(model), values_(model.stop_values), at_(2 * model.stops.size()) {}
  void set_parameters(std::span<const double> p) { values_.set_parameters(p); }

  /// The first time in (t + slack, end - slack) (s); `end` if there is none.
  double next(double t, double end, double slack) {
    double first = end;
    const auto offer = [&](double when) {
      if (when > t + slack && when < end - slack) first = std::min(first, when);
    };
    evaluate(0);
    const std::vector<double> zero = at_;
    const double now = t + 2 * slack;
    evaluate(now);
    const std::vector<double> here = at_;
    for (size_t k = 0; k < model_.stops.size(); ++k) {
      const double s0 = zero[2 * k], s1 = zero[2 * k + 1];
      if (model_.stops[k] == OdeModel::Stop::sampled) {
        offer(sampled(k, t + slack, end - slack));
      } else if (model_.stops[k] == OdeModel::Stop::piecewise) {
        if (here[2 * k + 1] != 0) offer(now - here[2 * k] / here[2 * k + 1]);
      } else if (s1 != 0) {
        double level = 0;
        if (model_.stops[k] == OdeModel::Stop::integer) {
          const double reached = s0 + s1 * (t + slack);
          level = s1 > 0 ? std::floor(reached) + 1 : std::ceil(reached) - 1;
        }
        offer((level - s0) / s1);
      }
    }
    return first;
  }

 private:
  void evaluate(double t) {
    values_(t, model_.initial.data(), model_.size(), model_.parameter_values.size(), at_.data());
  }
  double sampled(size_t k, double from, double to) {
    constexpr int kSamples = 64;
    const auto value = [&](double t) {
      evaluate(t);
      return at_[2 * k];
    };
    double low = from, at_low = value(from);
    for (int i = 1; i <= kSamples; ++i) {
      const double high = from + (to - from) * i / kSamples, at_high = value(high);
      if (at_low * at_high < 0) return bracketed_root(value, low, at_low, high, at_high, 1e-15 * to);
      low = high, at_low = at_high;
    }
    return to;
  }

  const OdeModel& model_;
  OdeEvaluation values_;
  std::vector<double> at_;
};

}  // namespace truestep::ode
