#include "engine/systems/grid_fluid/liquid/liquid.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/core/commands/command_checks.h"
#include "engine/systems/grid_fluid/grid_fluid.h"

namespace truestep::grid_fluid {

Liquid::Liquid(const GridFluidDef& def, const BuildContext& context)
    : id_(context.id), model_(def, context.gravity) {
  const mac::MacGrid& g = model_.grid;
  if (g.dimensions == 2) model_.gravity.z = 0;
  ObstaclePlaces start;
  model_.texts.place_obstacles(def.obstacles, 0, start);
  const std::vector<StartingPlace> places = starting_places(def, start.obstacles);
  if (places.empty() && !def.bodies.empty()) {
    const std::string why = "the bodies of liquid contain no particle: too small, or outside the box";
    throw Error("scene_invalid", why, {"/bodies", "empty", why, "", "larger bodies or more cells", "", ""});
  }
  capacity_ = largest_count(def, places.size());
  for (const LiquidInletDef& e : def.emitters) inlets_.emplace_back(def, e);
  double per = 1;
  for (size_t a = 0; a < g.dimensions; ++a) per *= def.particles_per_axis;
  mass_ = def.density * g.cell_volume() / per;

  add_columns(places);
  show();
  set_remedies({"a shorter dt", "a larger cfl, which takes fewer substeps", "fewer cells"});
  const auto x = start_.f64(kPosition), v = start_.f64(velocity_);
  const double t = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    const Vec3 at = places[i].at, push = def.bodies[places[i].body].velocity;
    store3(x.data(), i, at);
    const double own[] = {push.x, push.y, push.z};
    for (size_t c = 0; c < g.dimensions; ++c) {
      double u = 0;
      const ExpressionRows::Column in[] = {{&t, 0}, {&at.x, 0}, {&at.y, 0}, {&at.z, 0}};
      const ExpressionRows::Output to[] = {{&u, 1}};
      model_.texts.initial[c].rows.run(in, to, 0, 1);
      v[3 * i + c] = own[c] + u;
    }
  }

  const bool apic = def.advection == GridFluidDef::Advection::apic;
  add_stage("liquid",
            (changes(def) ? "up to " : "") + std::to_string(capacity_) + " particles through " +
                std::to_string(g.cell_count()) + " cells, " +
                (apic ? "affine (APIC)" : "changes from the grid (FLIP)") +
                "; pressure and density by conjugate gradients and multigrid",
            [this](State& s, const StepInput& in) { advance(s, in); });
  if (def.obstacles.empty()) skip_stage("obstacles", "no obstacles given");
  if (def.viscosity == 0) skip_stage("viscosity", "viscosity is 0");
  if (!model_.texts.forced) skip_stage("force", "no force but gravity given");
  if (def.emitters.empty()) skip_stage("births", "no emitters given");
  if (!def.any_regions()) skip_stage("removal", "no kill regions given");
}

void Liquid::add_columns(const std::vector<StartingPlace>& places) {
  const mac::MacGrid& g = model_.grid;
  const GridFluidDef& def = model_.def;
  const size_t n = places.size();
  start_.add({"position", "m", Scalar::f64, 3, Role::position}, n);
  velocity_ = start_.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, n);
  if (def.advection == GridFluidDef::Advection::apic) {
    const auto square = static_cast<uint32_t>(g.dimensions * g.dimensions);
    affine_ = start_.add({"affine", "1/s", Scalar::f64, square}, n);
  }
  if (norm(model_.gravity) > 0) owed_ = start_.add({"owed", "m^2/s^2"}, n);
  pressure_ = start_.add({"pressure", "m^2/s^2"}, g.size());
  fill_ = start_.add({"fill", "1"}, g.size());
  numbers_ = start_.add({"numbers", "1"}, kLiquidNumbers);
  if (dyed(def)) {
    dye_ = start_.add({"dye", "1"}, n);
    for (size_t i = 0; i < n; ++i) start_.f64(dye_)[i] = def.bodies[places[i].body].dye.value_or(0);
  }
  if (!changes(def)) return;
  id_column_ = start_.add({"id", "1", Scalar::u64}, n);
  layers_ = start_.add({"emitter.next_layer", "1", Scalar::u64}, inlets_.size());
  counts_ = start_.add({"counts", "1", Scalar::u64}, kCounts);
  for (size_t i = 0; i < n; ++i) start_.span<uint64_t>(id_column_)[i] = i;
  start_.span<uint64_t>(counts_)[kBorn] = n;
  size_t rows_of_particles = 0;
  for (size_t a = 0; a < g.dimensions; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      if (model_.kinds[a][end] != SideKind::inflow) continue;
      double across = 1;
      for (size_t b = 0; b < g.dimensions; ++b)
        across *= b == a ? 1 : static_cast<double>(g.cells[b]) * def.particles_per_axis;
      rows_of_particles += static_cast<size_t>(across);
    }
  }
  // The first particle is half a spacing behind the surface of what comes in.
  constexpr double kHalf = 0.5;
  if (rows_of_particles > 0) {
    phase_ = start_.add({"inflow.phase", "1"}, rows_of_particles);
    std::ranges::fill(start_.f64(phase_), kHalf);
  }
  for_particle_columns([&](State::Column c) { start_.reserve(c, capacity_); });
}

LiquidFields Liquid::fields(State& s) const {
  LiquidFields f;
  f.rows = rows(s);
  f.position = s.f64(kPosition).data(), f.velocity = s.f64(velocity_).data();
  if (affine_) f.affine = s.f64(affine_).data();
  f.pressure = s.f64(pressure_).data(), f.fill = s.f64(fill_).data();
  f.lifted = &s.f64(numbers_)[kLifted];
  if (owed_) f.owed = s.f64(owed_).data();
  return f;
}

void Liquid::advance(State& s, const StepInput& in) const {
  auto& flow = in.workspace.object<LiquidFlow>("grid_fluid.liquid");
  flow.bind(model_, inlets_, capacity_, in.arena);
  LiquidFields f = fields(s);
  flow.load(f);
  const mac::MacGrid& g = model_.grid;
  const double fall = (std::abs(model_.gravity.x) + std::abs(model_.gravity.y) + std::abs(model_.gravity.z)) /
                      g.spacing[0] * in.h;
  const double cfl = model_.def.cfl.value_or(1), start = flow.crossing_rate(in.t);
  const double wanted = std::ceil(in.h * (start + fall) / cfl - 1e-9);
  if (!(wanted <= kMostSubsteps)) {
    Instability e(id_, "velocity", -1,
                  "the liquid crosses " + short_number((start + fall) * in.h) +
                      " cells in a step: more than " + std::to_string(kMostSubsteps) +
                      " substeps would be needed");
    if (std::isfinite(wanted)) e.suggested_dt = in.h * kMostSubsteps / wanted;
    throw e;
  }
  const auto n = std::max(1, static_cast<int>(wanted));
  const double h = in.h / n;
  LiquidReport report;
  for (int i = 0; i < n; ++i) {
    const double t = in.t + i * h;
    report = flow.substep(f, t, h);
    if (!counts_) continue;
    flow.store(f);
    come_and_go(s, in, flow.given(), t, h);
    f = fields(s);
    flow.load(f);
  }
  const double end = flow.crossing_rate(in.t + in.h);
  flow.store(f);
  const auto numbers = s.f64(numbers_);
  numbers[kLiquidSubsteps] = n, numbers[kLiquidCfl] = std::max(start, end) * h;
  numbers[kLiquidIterations] = report.pressure.iterations,
  numbers[kLiquidResidual] = report.pressure.residual;
  numbers[kDensityIterations] = report.density.iterations;
  numbers[kMeanCompression] = report.mean_compression, numbers[kMaxCompression] = report.max_compression;
}

void Liquid::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind != CommandKind::impulse)
    refuse_command("type", "unsupported_command", "a liquid on a grid takes no such command", "impulse");
  refuse_place(c, "particle");
  const size_t row = checked_command_row(c, rows(s), "particle");
  if (model_.grid.dimensions == 2 && c.vector.z != 0)
    refuse_command("vector", "out_of_range", "a plane liquid must stay in z = 0");
  double* v = s.f64(velocity_).data();
  store3(v, row, load3(v, row) + c.vector / mass_);
}

}  // namespace truestep::grid_fluid
