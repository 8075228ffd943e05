// The guards of a model's events, one program for all of them, as integrators/control/events.h watches them.
// While an event rests, its guard is -g'': it crosses zero in the event's own direction when the contact
// ends.
#pragma once
#include <vector>

#include "engine/integrators/control/events.h"
#include "engine/systems/ode/ode_contacts.h"
#include "engine/systems/ode/ode_slides.h"

namespace truestep::ode {

class OdeGuards final : public Guards {
 public:
  /// The model must outlive this.
  explicit OdeGuards(const OdeModel& model, OdeContacts& contacts, OdeSlides& slides)
      : model_(model), contacts_(contacts), slides_(slides), values_(model.guards) {
    using Direction = OdeEventDef::Direction;
    for (size_t k = 0; k < model.events.size(); ++k) {
      const OdeEventDef& e = model.events[k].def;
      if (e.when.empty()) continue;
      events_.push_back(k);
      directions_.push_back(e.direction == Direction::any      ? Crossing::either
                            : e.direction == Direction::rising ? Crossing::rising
                                                               : Crossing::falling);
    }
    directions_.resize(directions_.size() + model.switched, Crossing::either);
  }
  void set_parameters(std::span<const double> p) { values_.set_parameters(p); }
  void evaluate(double t, const double* y, double* g) override {
    values_(t, y, model_.size(), model_.parameter_values.size(), g);
    for (size_t k = 0; k < model_.contacts.size(); ++k) {
      if (contacts_.resting(k)) g[k] = -contacts_.motion(k, t, y).acceleration;
    }
    for (size_t k = 0; k < slides_.count(); ++k) {
      double& side = g[events_.size() + k];
      side = slides_.sliding(k) ? slides_.hold(k, t, y) : slides_.clear_of_zero(k, y, side);
    }
  }
  std::span<const Crossing> directions() const { return directions_; }
  /// The event that a guard belongs to, or the side.
  size_t event(uint32_t guard) const { return events_[guard]; }
  bool is_side(uint32_t guard) const { return guard >= events_.size(); }
  size_t side(uint32_t guard) const { return guard - events_.size(); }

 private:
  const OdeModel& model_;
  OdeContacts& contacts_;
  OdeSlides& slides_;
  OdeEvaluation values_;
  std::vector<Crossing> directions_;
  std::vector<size_t> events_;
};

}  // namespace truestep::ode
