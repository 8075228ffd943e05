// What happens where guards cross zero: events fire, contacts begin and end their rest, sides of signs switch
// or slide.
#include <algorithm>

#include "engine/systems/ode/ode_scratch.h"

namespace truestep::ode {

using C = OdeColumns;

// Sides after something else than their own crossing has moved them.
void Ode::refresh_sides(State& s, Scratch& work, double t) const {
  if (model_.switched == 0) return;
  if (!work.slides->refresh(t, s.f64(C::kStates).data(), tolerance_.absolute)) return;
  work.set_parameters(s.f64(C::kParameters));
  forget(s);
  const auto signs = s.span<int32_t>(C::kEventSigns);
  const size_t first = signs.size() - model_.switched;
  for (size_t k = 0; k < model_.switched; ++k) {
    const double side = s.f64(C::kParameters)[work.slides->first() + k];
    signs[first + k] = work.slides->sliding(k) || side > 0 ? 1 : -1;
  }
}

// Handles the event of a guard that crosses zero, or the end of its contact.
void Ode::cross(State& s, Scratch& work, uint32_t guard, double t) const {
  if (work.guards->is_side(guard)) {
    const int32_t side = work.slides->turn(work.guards->side(guard), t, s.f64(C::kStates).data());
    work.departing.emplace_back(guard, side);
    work.set_parameters(s.f64(C::kParameters));
    return forget(s);
  }
  const size_t event = work.guards->event(guard);
  if (model_.contacts.empty() || !work.contacts->possible(guard)) return fire(s, work, event, t);
  OdeContacts& contacts = *work.contacts;
  const auto y = s.f64(C::kStates);
  if (contacts.resting(guard)) {
    work.departing.emplace_back(guard, s.span<int32_t>(C::kResting)[guard]);
    contacts.end(guard);
    return forget(s);
  }
  const int32_t side = s.span<int32_t>(C::kEventSigns)[guard];
  // Something moving away from zero only seems to cross it, because of rounding.
  if (side * contacts.motion(guard, t, y.data()).rate > 0) {
    work.departing.emplace_back(guard, side);
    return;
  }
  fire(s, work, event, t);
  if (side * contacts.motion(guard, t, y.data()).rate < 0) return;
  settle(s, work, guard, side, t);
  if (!contacts.resting(guard)) work.departing.emplace_back(guard, side);
}

// Brings to rest whatever would fly no farther than the tolerance.
void Ode::settle(State& s, Scratch& work, uint32_t guard, int32_t side, double t) const {
  const auto y = s.f64(C::kStates);
  work.rates.resize(y.size());
  work.equations->rest_on(nullptr);
  work.equations->rate(t, y.data(), work.rates.data());
  if (work.contacts->ends_here(guard, side, t, y.data(), work.rates.data(), tolerance_)) {
    work.contacts->begin(guard, side, t, y.data());
  }
}

// Resting contacts elsewhere keep resting unless the event has moved them.
void Ode::wake(State& s, Scratch& work, double t, std::span<const double> before) const {
  const auto y = s.f64(C::kStates);
  for (uint32_t k = 0; k < model_.contacts.size(); ++k) {
    if (!work.contacts->resting(k)) continue;
    const auto& c = model_.contacts[k];
    const auto moved = [&](uint32_t place) { return before[place] != y[place]; };
    if (std::ranges::none_of(c.places, moved) && std::ranges::none_of(c.watched, moved)) continue;
    work.departing.emplace_back(k, s.span<int32_t>(C::kResting)[k]);
    work.contacts->end(k);
  }
}

void Ode::fire(State& s, Scratch& work, size_t k, double t) const {
  const OdeModel::Event& e = model_.events[k];
  const auto y = s.f64(C::kStates), p = s.f64(C::kParameters);
  ++s.span<uint64_t>(C::kEventCounts)[k];
  if (!e.targets.empty()) {
    const bool rests = work.contacts->any();
    if (rests) work.rates.assign(y.begin(), y.end());
    work.event_values[k](t, y.data(), y.size(), p.size(), work.values.data());
    for (size_t i = 0; i < e.targets.size(); ++i) {
      (e.targets[i].kind == OdeModel::Event::Target::Kind::state ? y : p)[e.targets[i].place] =
          work.values[i];
    }
    work.set_parameters(p);
    forget(s);
    if (rests) wake(s, work, t, work.rates);
  }
  if (e.def.then == OdeEventDef::Then::stop) s.f64(C::kStopped)[0] = 1, s.f64(C::kStopped)[1] = t;
}

}  // namespace truestep::ode
