// Scratch memory of a step of equations: a thread's evaluations of the model, its watcher and its events.
#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "engine/systems/ode/ode.h"
#include "engine/systems/ode/ode_events.h"
#include "engine/systems/ode/ode_stops.h"

namespace truestep::ode {

/// Rebuilt whenever the workspace was discarded.
struct Ode::Scratch {
  const OdeModel* model = nullptr;
  std::unique_ptr<OdeEquations> equations;
  std::unique_ptr<OdeContacts> contacts;
  std::unique_ptr<OdeSlides> slides;
  std::unique_ptr<OdeGuards> guards;
  std::unique_ptr<EventWatcher> watcher;
  std::unique_ptr<OdeStops> stops;  ///< null: the equations do not jump in time
  std::vector<OdeEvaluation> event_values;
  std::vector<double> values;  ///< of an event's targets
  /// Guards whose event has just led away from zero, with the side: too short a flight is a crossing as well.
  std::vector<std::pair<uint32_t, int32_t>> departing;
  std::unique_ptr<OdeEvaluation> plot;
  std::vector<double> points;                               ///< produced by `plot`
  std::vector<double> start, middle, rate_start, rate_end;  ///< of the states, for tracers
  std::vector<double> rates;                                ///< of the states, or the states before an event

  void set_parameters(std::span<const double> p) {
    equations->set_parameters(p);
    guards->set_parameters(p);
    contacts->set_parameters(p);
    plot->set_parameters(p);
    if (stops) stops->set_parameters(p);
    for (OdeEvaluation& e : event_values) e.set_parameters(p);
  }
};

}  // namespace truestep::ode
