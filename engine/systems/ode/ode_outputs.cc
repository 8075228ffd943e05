// Descriptions of the outputs of the system type "ode".
#include "engine/core/outputs.h"
#include "engine/systems/ode/ode_def.h"

namespace truestep::ode {

const Outputs& ode_outputs() {
  static const Outputs kOutputs{
      .rows =
          "an element of an array state (a number state has only row 0); for position a tracer, or a drawn "
          "point followed by the past ones of its trail",
      .fields = {{"position", "m", 3, "tracers, or the points of plot and their trails"},
                 {"tag", "1", 1, "tracers: initial position along x, 0 to 1"},
                 {"<state>", "1", 1, "a state by its name, an array with one row per element"}},
      .observables = {{"<state>", "1", "value of a number state"},
                      {"<state>.<k>", "1", "element k of an array of at most 16"},
                      {"<invariant>", "1", "value of an invariant"},
                      {"<invariant>.drift", "1",
                       "change since the start, relative to the start; absolute where that is 0"},
                      {"events.<name>", "1", "number of times the event has happened"},
                      {"stopped", "1", "1 once an event has stopped the system"},
                      {"stopped.time", "s", "time of the stop; until then the present time"},
                      {"tracers.count", "1", "number of tracers"},
                      {"tracers.<axis>.min", "m", "smallest coordinate along x, y or z"},
                      {"tracers.<axis>.max", "m", "largest"},
                      {"tracers.<axis>.mean", "m", "mean"},
                      {"integrator.steps", "1", "internal steps taken since the start"},
                      {"integrator.rejected", "1", "rejected internal steps"},
                      {"integrator.rates", "1", "evaluations of the right-hand sides"},
                      {"integrator.jacobians", "1", "evaluations of their derivatives"}}};
  return kOutputs;
}

}  // namespace truestep::ode
