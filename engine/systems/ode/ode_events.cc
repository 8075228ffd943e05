#include "engine/systems/ode/ode_events.h"

#include <algorithm>

namespace truestep {

namespace {
int32_t side(double g) {
  return g > 0 ? 1 : g < 0 ? -1 : 0;
}
}  // namespace

OdeCrossings::OdeCrossings(const OdeModel& model)
    : model_(model), guards_(model.guards), values_(model.guards.outputs()), point_(model.size()) {
  fired_.reserve(model.events.size());
  fired_side_.reserve(model.events.size());
}

void OdeCrossings::evaluate(double t, const double* y) {
  guards_(t, y, model_.size(), model_.parameter_values.size(), values_.data());
}

bool OdeCrossings::crosses(size_t k) const {
  const OdeModel::Event& e = model_.events[k];
  if (e.def.when.empty() || signs_[k] == 0) return false;
  const int32_t now = side(values_[e.guard]);
  if (now == signs_[k]) return false;
  using Direction = OdeEventDef::Direction;
  return e.def.direction == Direction::any ||
         (e.def.direction == Direction::rising ? signs_[k] < 0 : signs_[k] > 0);
}

void OdeCrossings::look(double t, const double* y) {
  evaluate(t, y);
  for (size_t k = 0; k < model_.events.size(); ++k) {
    if (!model_.events[k].def.when.empty()) signs_[k] = side(values_[model_.events[k].guard]);
  }
  for (size_t i = 0; i < fired_.size(); ++i) {
    if (signs_[fired_[i]] == fired_side_[i]) signs_[fired_[i]] = 0;
  }
}

StepWatcher::Verdict OdeCrossings::accepted(double t0, double& t1, double* y1, const Interpolant& between) {
  const double h = t1 - t0;
  const auto any = [this] {
    for (size_t k = 0; k < model_.events.size(); ++k) {
      if (crosses(k)) return true;
    }
    return false;
  };
  double low = 0;
  for (const double theta : {0.25, 0.5, 0.75, 1.0}) {
    const double* y = y1;
    if (theta < 1) {
      between.at(theta, point_.data());
      y = point_.data();
    }
    evaluate(t0 + theta * h, y);
    if (!any()) {
      for (size_t k = 0; k < model_.events.size(); ++k) {
        if (!model_.events[k].def.when.empty()) signs_[k] = side(values_[model_.events[k].guard]);
      }
      low = theta;
      continue;
    }
    // The earliest crossing of any guard: halve until no number lies between.
    double high = theta;
    while (true) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high || (high - low) * h <= 1e-16 * (t0 + h)) break;
      between.at(middle, point_.data());
      evaluate(t0 + middle * h, point_.data());
      (any() ? high : low) = middle;
    }
    if (high < 1) {
      between.at(high, point_.data());
      t1 = t0 + high * h;
      std::copy(point_.begin(), point_.end(), y1);
    }
    evaluate(t1, y1);
    for (size_t k = 0; k < model_.events.size(); ++k) {
      if (!crosses(k)) continue;
      fired_.push_back(static_cast<uint32_t>(k));
      fired_side_.push_back(side(values_[model_.events[k].guard]));
    }
    // The point that the loop ended on crosses by construction; its time may have moved by rounding.
    if (fired_.empty()) return Verdict::go_on;
    return Verdict::stop;
  }
  return Verdict::go_on;
}

}  // namespace truestep
