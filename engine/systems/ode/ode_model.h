// A scene's equations compiled: layout of states and parameters, right-hand side, Jacobian, accelerations,
// events, invariants and plot, each a program over the same variables
//   t, parameters, states
// in this order. If all states pair up as x' = v with v a state, the x come first, then their velocities in
// the same order, and the system is also available as second-order equations.
#pragma once
#include <string>
#include <vector>

#include "engine/base/errors.h"
#include "engine/core/drawing.h"
#include "engine/core/equations/right_hand_side.h"
#include "engine/math/expression/program.h"
#include "engine/math/expression/rows.h"
#include "engine/systems/ode/ode_def.h"

namespace truestep::ode {

/// A matrix of derivatives: its shape and the program that computes its values in the shape's order.
struct OdeMatrix {
  MatrixShape::Kind kind = MatrixShape::Kind::dense;
  size_t lower = 0, upper = 0;
  std::vector<int32_t> column_start, rows;
  ExpressionProgram program;  ///< no outputs: too large to differentiate

  MatrixShape shape() const { return {kind, lower, upper, column_start, rows}; }
};

struct OdeModel {
  /// A named state or parameter: indices of its elements among the states or parameters.
  struct Named {
    std::string name;
    std::vector<uint32_t> places;
    NamedNumbers::Form form = NamedNumbers::Form::number;
  };
  struct Event {
    std::string name;
    OdeEventDef def;
    struct Target {
      enum class Kind : uint8_t { state, parameter } kind;
      uint32_t place;
    };
    std::vector<Target> targets;
    ExpressionProgram values;  ///< of the targets
  };

  /// The contact against which a guard's event may come to rest (ode_contacts.h).
  struct Contact {
    std::vector<uint32_t> places;   ///< states that the event sets and on which g' depends; empty: no contact
    std::vector<uint32_t> watched;  ///< other states that g depends on
    ExpressionProgram program;      ///< g', g'', then dg'/dy of `places`
  };

  std::vector<Named> states, parameters;
  std::vector<double> initial, parameter_values;
  std::vector<std::string> labels;  ///< of every state: "x", "x[3]", "x'"
  std::vector<double> absolute_tolerances;

  ExpressionProgram rate, invariants, plot;
  ExpressionProgram guards;       ///< of the events with a `when`, in their order
  std::vector<Contact> contacts;  ///< one per guard, or none at all
  OdeMatrix jacobian;
  bool autonomous = false;

  /// Where the right-hand side jumps at times that depend on t and parameters alone (ode_stops.h).
  enum class Stop : uint8_t {
    crossing,   ///< s0 + s1 t crosses zero
    integer,    ///< the same reaches a whole number
    piecewise,  ///< straight between stops of other kinds
    sampled     ///< any function of time changes its sign
  };
  std::vector<Stop> stops;
  bool switches = false;          ///< whether it jumps where states cross something
  ExpressionProgram stop_values;  ///< of each: its value, and its slope

  /// Signs of expressions of the states (ode_slides.h): the last parameters are their sides, the last guards
  /// the expressions.
  size_t switched = 0;
  ExpressionProgram slides;  ///< of each: g, g', then dg'/ds of every side

  bool second_order = false;
  bool depends_on_velocity = true;
  ExpressionProgram acceleration;
  OdeMatrix acceleration_jacobian;  ///< values of da/dx, then of da/dv

  std::vector<std::string> invariant_names;
  std::vector<Event> events;
  std::vector<PlotAxis> axes;       ///< of the plot
  std::vector<std::string> curves;  ///< states shown by the points, if each shows one of its own
  size_t bodies = 0;                ///< points produced by `plot`, 3 coordinates each

  ExpressionRows tracer_velocity;  ///< over the variables, then x, y, z; no outputs: no tracers

  size_t size() const { return initial.size(); }
  size_t variables() const { return 1 + parameter_values.size() + initial.size(); }
  /// The state or parameter element with that name ("x", "m[3]"); empty when there is none.
  std::optional<Event::Target> find(std::string_view name) const;
};

/// Throws Error "scene_invalid" with every fault of the scene's texts, pointers below the system.
OdeModel compile_ode(const OdeDef& def);

}  // namespace truestep::ode
