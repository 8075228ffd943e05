#include "engine/systems/ode/ode_def.h"

#include <algorithm>
#include <cmath>

namespace truestep::ode {

namespace {

const DefTable& tracers_table() {
  using D = TracersDef;
  static const DefTable kTable =
      TableOf<D>("massless points carried by a velocity field, which may depend on the states")
          .named_texts("velocity", &D::velocity, {1, 3},
                       "dx/dt, dy/dt, dz/dt as expressions of x, y, z, t ...")
          .required()
          .integer("count", &D::count, between(0, 5e6), "points drawn at random inside the box")
          .integers("grid", &D::grid, between(1, 5e6), {3, 3},
                    "nx, ny, nz points, spaced evenly over the box")
          .vectors("points", &D::points, "m", any(), {0, 5'000'000}, "initial position of each point")
          .vector("box_min", &D::box_min, "m", any(), "lower corner of the box")
          .vector("box_max", &D::box_max, "m", any(), "upper corner of the box")
          .choice("method", &D::method, {"euler", "midpoint", "heun", "rk4"},
                  "fixed-step method, one step per substep")
          .check([](const D& d, const DefTable::Report& report) {
            const int kinds = (d.count > 0) + !d.grid.empty() + !d.points.empty();
            if (kinds != 1) report("", "give exactly one of count, grid and points");
            for (size_t k = 0; k < d.velocity.size(); ++k) {
              const std::string& n = d.velocity[k].name;
              if (n != "x" && n != "y" && n != "z")
                report("/velocity/" + n, "only x, y and z have a velocity");
            }
            if (!(d.box_min.x <= d.box_max.x && d.box_min.y <= d.box_max.y && d.box_min.z <= d.box_max.z)) {
              report("/box_max", "the upper corner is below the lower one");
            }
          })
          .build();
  return kTable;
}

const DefTable& event_table() {
  using D = OdeEventDef;
  static const DefTable kTable =
      TableOf<D>("something that happens at a time, periodically, or when an expression crosses zero")
          .text("name", &D::name, "its count is observed as events.<name>; default: its index")
          .number("at", &D::at, "s", at_least(0), "once, at this time")
          .number("every", &D::every, "s", above(0), "at every positive multiple of this time")
          .text("when", &D::when,
                "expression whose zero crossings count, located on the method's interpolant")
          .choice("direction", &D::direction, {"any", "rising", "falling"},
                  "direction of the crossings that count")
          .named_texts("set", &D::set, {0, 1000},
                       "new values of states and parameters; all are evaluated before any is set")
          .choice("then", &D::then, {"go_on", "stop"}, "stop: the system does not change from then on")
          .check([](const D& d, const DefTable::Report& report) {
            const int kinds = d.at.has_value() + d.every.has_value() + !d.when.empty();
            if (kinds != 1) report("", "give exactly one of at, every and when");
            if (d.name.size() > 64) report("/name", "at most 64 characters");
          })
          .build();
  return kTable;
}

size_t total(const std::vector<NamedNumbers>& entries) {
  size_t n = 0;
  for (const NamedNumbers& e : entries) n += e.values.size();
  return n;
}

}  // namespace

const DefTable& ode_table() {
  using D = OdeDef;
  static const DefTable kTable = [] {
    const Count names{0, 1000};
    TableOf<D> t("named states, parameters and right-hand sides as expressions; vector fields with tracers");
    t.named_numbers("states", &D::states, any(), names,
                    "initial values: \"x\": 1, or an array \"x\": [1, 2, 3]")
        .named_numbers("velocities", &D::velocities, any(), names,
                       "initial values of x' for states with an equation of second order; 0 when absent")
        .named_numbers("parameters", &D::parameters, any(), names,
                       "numbers and arrays used in equations; set_parameter may change them")
        .named_texts("let", &D::let, names,
                     "definitions, in order: \"r\": \"sqrt(x^2 + y^2)\", \"d[i, j]\": \"x[i] - x[j]\"")
        .named_texts(
            "equations", &D::equations, names,
            "dx/dt of every state; \"x[i]\": ... for all elements of an array, \"x[0]\": ... for one. "
            "Expressions: + - * / ^ < <= > >= == != && || ?: , sqrt abs sign floor exp log sin cos tan "
            "asin acos atan atan2 pow min max, pi, t, sum(j != i, m[j] * x[j]), len(x)")
        .named_texts("second", &D::second, names, "d2x/dt2; the velocity is named x'")
        .named_texts("invariants", &D::invariants, names, "conserved quantities to observe with their drift")
        .objects("events", &D::events, event_table(), {0, 64}, "events during the run")
        .object("tracers", &D::tracers, tracers_table(), "points carried by a velocity field")
        .named_numbers("absolute_tolerances", &D::absolute_tolerances, above(0), names,
                       "absolute tolerance of single states")
        .texts("plot", &D::plot, {1, 3},
               "drawn coordinates x, y, z: states, arrays (one point per element) or expressions; [i] is the "
               "point's own element")
        .texts("axes", &D::axes, {0, 3},
               "what the axes of `plot` show, in words; without them the states' names or the expressions")
        .texts("curves", &D::curves, {0, 64}, "names of the points of `plot`, whose paths are its curves")
        .integer("trail", &D::trail, between(0, 100000), "past steps shown by the drawn path")
        .number("draw_radius", &D::draw_radius, "m", at_least(0), "of the drawn points")
        .vector("color", &D::color, "1", between(0, 1), "red, green, blue of the points");
    add_integrator_rows(t);
    t.number("max_step", &D::max_step, "s", above(0),
             "adaptive methods: longest internal step, where something short could be stepped over; absent: "
             "any");
    t.check([](const D& d, const DefTable::Report& report) {
      if (d.states.empty() && !d.tracers) report("/states", "a system needs states or tracers");
    });
    return t.build();
  }();
  return kTable;
}

Cost ode_cost(const void* def) {
  const auto& d = *static_cast<const OdeDef*>(def);
  const double n = static_cast<double>(total(d.states) + d.second.size() + total(d.velocities));
  double longest = 1;
  for (const auto* list : {&d.states, &d.parameters}) {
    for (const NamedNumbers& e : *list) longest = std::max(longest, static_cast<double>(e.values.size()));
  }
  // One operation per four characters; a family repeats its text, each sum repeats its terms.
  const auto operations = [longest](const std::vector<NamedText>& texts) {
    double sum = 0;
    for (const NamedText& e : texts) {
      double one = 1 + static_cast<double>(e.text.size()) / 4;
      if (e.name.find('[') != std::string::npos) one *= longest;
      for (size_t at = e.text.find("sum("); at != std::string::npos; at = e.text.find("sum(", at + 4))
        one *= longest;
      sum += one;
    }
    // The expansion of a system is bounded.
    return std::min(sum, 1.5e6);
  };
  double points = 0, tracer_operations = 0;
  if (d.tracers) {
    const TracersDef& t = *d.tracers;
    points = t.count + static_cast<double>(t.points.size());
    if (t.grid.size() == 3) {
      points +=
          static_cast<double>(t.grid[0]) * static_cast<double>(t.grid[1]) * static_cast<double>(t.grid[2]);
    }
    for (const NamedText& v : t.velocity) tracer_operations += 4 + static_cast<double>(v.text.size()) / 4;
  }
  const double work = operations(d.equations) + operations(d.second);
  Cost c;
  c.state_bytes = 16 * n + 24 * points + 24 * d.trail.value_or(400) + 5e3;
  // Programs and stages; an implicit method's matrix is dense below 100 states and sparse above.
  c.workspace_bytes = 240 * work + 8 * (30 * n + std::min(n, 100.0) * n) + 24 * points;
  c.elements = n + points;
  // Measured: about 30 right-hand sides per step; 4 stages per tracer, 3 ns per operation and point. A long
  // trail does not stay in the cache from step to step.
  const double trail = 1e-9 * std::max(static_cast<double>(d.trail.value_or(400)) - 600, 0.0);
  c.seconds_per_step = 1.3e-6 + trail + 25e-9 * work + 4 * 0.8e-9 * tracer_operations * points;
  return c;
}

}  // namespace truestep::ode
