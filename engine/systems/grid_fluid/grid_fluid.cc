#include "engine/systems/grid_fluid/grid_fluid.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/core/commands/command_checks.h"
#include "engine/systems/grid_fluid/liquid/liquid.h"
#include "engine/systems/grid_fluid/steady/becomes_steady.h"
#include "engine/systems/grid_fluid/steady/steady_flow.h"

namespace truestep::grid_fluid {

namespace {
constexpr const char* kAxes[] = {"x", "y", "z"};
constexpr double kTwoStepCells = 0.5;  ///< crossed in a substep of Adams and Bashforth's
}  // namespace

GridFluid::GridFluid(const GridFluidDef& def, const BuildContext& context)
    : id_(context.id), model_(def, context.gravity) {
  const mac::MacGrid& g = model_.grid;
  ObstaclePlaces start;
  model_.texts.place_obstacles(def.obstacles, 0, start);
  room_ = fluid_volume(start.obstacles, g);
  for (size_t c = 0; c < g.dimensions; ++c) {
    start_.add({std::string("velocity.") + kAxes[c], "m/s", Scalar::f64, 1, Role::position}, g.size());
  }
  start_.add({"pressure", "m^2/s^2", Scalar::f64, 1, Role::internal}, g.size());
  numbers_ = start_.add({"numbers", "1", Scalar::f64, 1, Role::internal},
                        kNumbers + (model_.keeps_divergence() ? 1u : 0u) +
                            (model_.texts.obstacles_turn ? 1u : 0u) + (model_.two_fluids() ? 1u : 0u));
  if (def.advection == GridFluidDef::Advection::central && def.stepping == GridFluidDef::Stepping::ab2) {
    for (size_t c = 0; c < g.dimensions; ++c) {
      const auto column =
          start_.add({std::string("rate.") + kAxes[c], "m/s^2", Scalar::f64, 1, Role::internal}, g.size());
      if (c == 0) rate_ = column;
    }
  }
  if (def.steady()) {
    SteadyFlow::check(model_);
    stream_ = start_.add({"stream", "m^2/s", Scalar::f64, 1, Role::internal}, g.size());
    start_.add({"steady", "1", Scalar::f64, 1, Role::internal}, kSteadyNumbers);
  }
  if (def.scalar) scalar_ = start_.add({"scalar", "1", Scalar::f64, 1, Role::position}, g.size());
  if (model_.two_fluids()) {
    second_ = start_.add({"second_fluid", "1", Scalar::f64, 1, Role::position}, g.size());
    start_.add({"border", "1", Scalar::f64, 1, Role::internal}, g.size());
    for (const State::Column column : {*second_, border_column()})
      model_.fill_second(start_.f64(column).data());
  }
  start_.f64(numbers_)[kViscosity] = def.viscosity;
  show();

  if (stream_) {
    set_remedies({"more viscosity, lowered while the session runs: each flow starts the search for the next",
                  "more cells, a power of two times sixteen: each coarser grid starts the search on the next",
                  "stepping rk3: a flow that sheds eddies has no stable steady state"});
  } else {
    set_remedies({"a shorter dt",
                  "advection along paths (semi_lagrangian, maccormack, bfecc), which is stable for any step",
                  "more cells, or more viscosity: eddies smaller than a cell cannot be resolved"});
  }
  if (def.steady()) {
    add_stage("steady", std::to_string(g.cell_count()) + " cells, by Newton's method on the stream function",
              [this](State& s, const StepInput& in) { find_steady(s, in); });
    return;
  }
  static const ThreadArena kSerial(1);
  Flow flow;
  flow.bind(model_, kSerial);
  FlowFields f = fields(start_);
  for (size_t c = 0; c < g.dimensions; ++c) model_.texts.sample(model_.texts.initial[c], g, c, 0, f.u[c]);
  if (f.scalar) model_.texts.sample(model_.texts.scalar_initial, g, mac::kCentre, 0, f.scalar);
  flow.weigh(f);
  flow.project(f, 0, 0);

  const bool central = def.advection == GridFluidDef::Advection::central;
  const bool stages = def.stepping == GridFluidDef::Stepping::rk3;
  add_stage(
      "flow",
      std::to_string(g.cell_count()) + " cells, " +
          (central ? std::string("central differences, ") + (stages ? "three stages" : "two steps") +
                         " each projected"
                   : "advected along paths, then projected") +
          (model_.solids.any() || model_.two_fluids() ? "; pressure by conjugate gradients and multigrid"
                                                      : "; pressure by transforms") +
          steady_offer(def),
      [this](State& s, const StepInput& in) { advance(s, in); });
  if (def.obstacles.empty()) skip_stage("obstacles", "no obstacles given");
  if (def.viscosity == 0) skip_stage("viscosity", "viscosity is 0");
  if (!def.scalar) skip_stage("scalar", "no scalar given");
  if (!model_.texts.forced) skip_stage("force", "no force given");
}

FlowFields GridFluid::fields(State& s) const {
  FlowFields f;
  for (size_t c = 0; c < model_.grid.dimensions; ++c) {
    f.u[c] = s.f64(static_cast<State::Column>(c)).data();
    if (rate_) f.rate[c] = s.f64(*rate_ + static_cast<State::Column>(c)).data();
  }
  f.pressure = s.f64(pressure_column()).data();
  if (scalar_) f.scalar = s.f64(*scalar_).data();
  if (second_) f.second = s.f64(border_column()).data(), f.border_h = s.f64(numbers_)[kBorderStep];
  f.viscosity = s.f64(numbers_)[kViscosity];
  f.last_h = s.f64(numbers_)[kLastStep];
  return f;
}

double GridFluid::largest_substep(double crossing_rate, double viscosity, double h) const {
  const GridFluidDef& d = model_.def;
  const bool central = d.advection == GridFluidDef::Advection::central;
  const bool rk3 = d.stepping == GridFluidDef::Stepping::rk3;
  // Three-stage Runge-Kutta is stable on the imaginary axis up to 1.73; the two-step method is not stable
  // there, and grows slowly enough only well below 1.
  const double cfl = d.cfl.value_or(!central ? 3 : rk3 ? 1.2 : kTwoStepCells);
  double largest = crossing_rate > 0 ? std::min(h, cfl / crossing_rate) : h;
  // The border moves with the velocity that its own weight has just changed: a leapfrog, stable up to 2, of
  // which half is used.
  if (const double rate = model_.border_rate(); rate > 0) largest = std::min(largest, 1 / rate);
  if (model_.two_viscosities()) {
    // The stress's sum of second differences is 3/2 of the Laplacian's, beside a border twice that.
    constexpr double kStress = 3;
    viscosity = kStress * std::max(viscosity, *d.second_fluid->viscosity);
  }
  if (central &&
      (d.viscous == GridFluidDef::Viscous::explicit_ || model_.sharp_walls() || model_.two_viscosities())) {
    double rate = 0;
    for (size_t a = 0; a < model_.grid.dimensions; ++a)
      rate += 4 / (model_.grid.spacing[a] * model_.grid.spacing[a]);
    // Ends of the stable real axes of the methods.
    if (viscosity > 0) largest = std::min(largest, (rk3 ? 2.5 : 1.0) / (viscosity * rate));
  }
  return largest;
}

// Three-stage Runge-Kutta allows sqrt(3) cells, the two-step method about 1.
double GridFluid::most_crossed() const {
  const GridFluidDef& d = model_.def;
  if (d.advection != GridFluidDef::Advection::central) return kMostTraced;
  return d.stepping == GridFluidDef::Stepping::rk3 ? std::sqrt(3.0) : 1;
}

int GridFluid::substeps_for(double crossing, double viscosity, double h, int taken) const {
  const double wanted = std::ceil(h / largest_substep(crossing, viscosity, h) - 1e-9);
  if (!(wanted + taken <= kMostSubsteps)) {
    const bool viscous = wanted > std::ceil(h / largest_substep(crossing, 0, h) - 1e-9);
    Instability e(
        id_, "velocity.x", -1,
        (viscous ? "explicit viscosity holds " + short_number(largest_substep(crossing, viscosity, h)) + " s"
                 : "the flow crosses " + short_number(crossing * h) + " cells in a step") +
            ": more than " + std::to_string(kMostSubsteps) + " substeps would be needed");
    if (std::isfinite(wanted)) e.suggested_dt = h * kMostSubsteps / wanted;
    throw e;
  }
  return std::max(1, static_cast<int>(wanted));
}

namespace {
/// 1/s^2, the most that buoyancy adds to the crossing rate in a second: a uniform part of the scalar moves
/// nothing.
double buoyancy_rate(const FlowModel& m, const double* scalar, const ThreadArena& arena) {
  if (!scalar || m.def.scalar->expansion == 0) return 0;
  const mac::MacGrid& g = m.grid;
  const double first = scalar[g.base()];
  const auto most = [&](double sign) {
    return mac::largest_of_rows(g, mac::kCentre, arena, [&](size_t at, size_t n) {
      double out = 0;
      for (size_t i = at; i < at + n; ++i) out = std::max(out, sign * (scalar[i] - first));
      return out;
    });
  };
  const double along[] = {m.gravity.x, m.gravity.y, m.gravity.z};
  double rate = 0;
  for (size_t a = 0; a < g.dimensions; ++a) rate += std::abs(along[a]) / g.spacing[a];
  return rate * std::abs(m.def.scalar->expansion) * (most(1) + most(-1));
}
}  // namespace

// Substeps are equal while they are short enough: if the flow becomes faster on the way, the rest of the step
// is divided anew. None is so long that buoyancy alone would carry the flow too far in it.
void GridFluid::advance(State& s, const StepInput& in) const {
  auto& flow = in.workspace.object<Flow>("grid_fluid");
  flow.bind(model_, in.arena);
  FlowFields f = fields(s);
  const auto numbers = s.f64(numbers_);
  // The two-step method grows slowly above this many cells, and would do so for the whole step.
  constexpr double kMargin = 1.25;
  const GridFluidDef& d = model_.def;
  const bool two_steps =
      d.advection == GridFluidDef::Advection::central && d.stepping == GridFluidDef::Stepping::ab2;
  const double most =
      std::max(two_steps ? kMargin * kTwoStepCells : most_crossed(), kMargin * d.cfl.value_or(0));
  const double buoyancy = buoyancy_rate(model_, f.scalar, in.arena);
  double from = in.t, rest = in.h, h = 0;
  int taken = 0;
  for (int n = 0, i = 0; i < n || n == 0; ++i) {
    const double crossing = n == 0 || n > 1 ? flow.crossing_rate(f, from + i * h) : 0;
    if (n == 0 || crossing * h > most) {
      from += i * h, rest -= i * h;
      n = substeps_for(crossing, f.viscosity, rest, taken);
      if (buoyancy > 0) {
        // (crossing + buoyancy h) h = most
        const double longest = 2 * most / (crossing + std::sqrt(crossing * crossing + 4 * buoyancy * most));
        const double wanted = std::ceil(rest / longest - 1e-9);
        n = std::max(n, static_cast<int>(std::min(wanted, 1.0 * kMostSubsteps)));
      }
      h = rest / n, i = 0;
    }
    f.impulse = {}, f.turning = 0;
    flow.substep(f, from + i * h, h);
    ++taken;
  }
  numbers[kIterations] = f.solved.iterations, numbers[kResidual] = f.solved.residual;
  numbers[kDrag] = model_.def.density * f.impulse[0] / h,
  numbers[kLift] = model_.def.density * f.impulse[1] / h;
  if (model_.texts.obstacles_turn) numbers[kTorque] = model_.def.density * f.turning / h;
  numbers[kLastStep] = f.last_h, numbers[kSubsteps] = taken;
  if (second_) {
    flow.bring_up(f, in.t + in.h, s.f64(*second_).data());
    numbers[kBorderStep] = f.border_h;
  }
  numbers[kCfl] = flow.crossing_rate(f, in.t + in.h) * h;
  if (model_.keeps_divergence()) numbers[kDivergence] = flow.largest_divergence(f, in.t + in.h);
}

// The flow is found in the first step, and again after a change of viscosity, starting from the current flow.
void GridFluid::find_steady(State& s, const StepInput& in) const {
  const auto found = s.f64(*stream_ + 1);
  FlowFields f = fields(s);
  if (found[kFoundFor] == f.viscosity) return;
  auto& steady = in.workspace.object<SteadyFlow>("grid_fluid.steady");
  steady.bind(model_, in.arena);
  double* psi = s.f64(*stream_).data();
  const auto from = found[kFoundFor] > 0 ? SteadyFlow::From::psi : SteadyFlow::From::rest;
  const SteadyFlow::Outcome out = steady.solve(psi, f.viscosity, from, model_.def.tolerance);
  if (!out.found) {
    throw Instability(id_, "velocity.x", -1,
                      "no steady flow found in " + std::to_string(out.iterations) +
                          " iterations; the last one changed the velocity by " +
                          short_number(100 * out.change) + " %");
  }
  found[kFoundFor] = f.viscosity, found[kSteadyIterations] = out.iterations, found[kChange] = out.change;
  steady.fields(psi, f);
  if (model_.keeps_divergence()) s.f64(numbers_)[kDivergence] = steady.largest_divergence(f);
}

void GridFluid::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind == CommandKind::set_parameter) {
    if (c.name != "viscosity") {
      refuse_command("name", "unknown_parameter", "no parameter " + c.name + " to set", "viscosity");
    }
    if (!(c.value >= 0)) refuse_command("value", "out_of_range", "the viscosity must be at least 0", ">= 0");
    if (stream_ && c.value == 0)
      refuse_command("value", "out_of_range", "a steady flow needs viscosity above 0", "> 0");
    s.f64(numbers_)[kViscosity] = c.value;
  } else if (c.kind == CommandKind::impulse) {
    if (stream_)
      refuse_command("type", "unsupported_command", "a steady flow takes no impulse", "set_parameter");
    if (!c.at) refuse_command("at", "missing", "an impulse on a fluid needs the point where it acts");
    const mac::MacGrid& g = model_.grid;
    const double at[] = {c.at->x, c.at->y, c.at->z}, vector[] = {c.vector.x, c.vector.y, c.vector.z};
    size_t cell[3] = {};
    for (size_t a = 0; a < g.dimensions; ++a) {
      const double place = (at[a] - g.origin[a]) / g.spacing[a];
      if (!(place >= 0 && place <= static_cast<double>(g.cells[a]))) {
        refuse_command("at", "out_of_range", "the point lies outside the box");
      }
      cell[a] = std::min(static_cast<size_t>(place), g.cells[a] - 1);
    }
    for (size_t a = 0; a < g.dimensions; ++a) {
      const auto [first, last] = model_.unknown(a, a);
      const size_t at_cell = g.at(cell[0], cell[1], cell[2]);
      const double density = model_.density_of(second_ ? s.f64(*second_)[at_cell] : 0);
      const double change = 0.5 * vector[a] / (density * g.cell_volume());
      auto u = s.f64(static_cast<State::Column>(a));
      if (cell[a] >= first) u[at_cell] += change;
      if (cell[a] + 1 < last) u[at_cell + g.stride(a)] += change;
    }
    // Moving obstacles are already where the next step finds them, and that step projects as well.
    if (!model_.texts.obstacles_move) {
      static const ThreadArena kSerial(1);
      Flow flow;
      flow.bind(model_, kSerial);
      FlowFields f = fields(s);
      flow.weigh(f);
      flow.project(f, 0, 0);
    }
  } else {
    refuse_command("type", "unsupported_command", "grid_fluid takes no such command",
                   "impulse, set_parameter");
  }
  s.f64(numbers_)[kLastStep] = 0;
}

void GridFluid::warn(const State& s, double h, std::vector<Warning>& out) const {
  const auto numbers = s.f64(numbers_);
  warn_of_crossing(numbers[kCfl], most_crossed(), h / std::max(1.0, numbers[kSubsteps]), out);
}

void warn_of_crossing(double cells, double most, double h, std::vector<Warning>& out) {
  if (!(cells > most)) return;
  Warning w{.quantity = "cfl", .value = cells, .limit = most, .suggested_dt = h * most / cells};
  w.detail = "the flow crosses " + short_number(cells) + " cells in a substep; results are reliable up to " +
             short_number(most) + "; dt " + short_number(w.suggested_dt) + " s or a cfl of at most " +
             short_number(most) + " would do";
  out.push_back(std::move(w));
}

std::unique_ptr<const System> build_grid_fluid(const void* def, const BuildContext& context) {
  const auto& d = *static_cast<const GridFluidDef*>(def);
  if (d.liquid()) return std::make_unique<Liquid>(d, context);
  return std::make_unique<GridFluid>(d, context);
}

}  // namespace truestep::grid_fluid
