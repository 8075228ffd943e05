#include "engine/systems/grid_fluid/liquid/liquid.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/core/commands/command_checks.h"
#include "engine/systems/grid_fluid/grid_fluid.h"

namespace truestep::grid_fluid {

namespace {
enum Number : size_t {
  kSubsteps,
  kCfl,
  kIterations,
  kResidual,
  kDensityIterations,
  kMeanCompression,
  kMaxCompression,
  kNumbers
};
constexpr State::Column kPosition = 0;
}  // namespace

Liquid::Liquid(const GridFluidDef& def, const BuildContext& context)
    : id_(context.id), model_(def, context.gravity) {
  const mac::MacGrid& g = model_.grid;
  if (g.dimensions == 2) model_.gravity.z = 0;
  ObstaclePlaces start;
  model_.texts.place_obstacles(def.obstacles, 0, start);
  const std::vector<StartingPlace> places = starting_places(def, start.obstacles);
  if (places.empty()) {
    const std::string why = "the bodies of liquid contain no particle: too small, or outside the box";
    throw Error("scene_invalid", why, {{"/bodies", "empty", why, "", "larger bodies or more cells", "", ""}});
  }
  rows_ = places.size();
  double per = 1;
  for (size_t a = 0; a < g.dimensions; ++a) per *= def.particles_per_axis;
  mass_ = def.density * g.cell_volume() / per;

  PartInfo points;
  points.fields = {{"position", "m", Scalar::f64, 3, Meaning::position},
                   {"velocity", "m/s", Scalar::f64, 3, Meaning::velocity},
                   {"speed", "m/s"},
                   {"pressure", "Pa"},
                   {"fill", "1"}};
  points.max_rows = rows_;
  set_parts({std::move(points)});
  set_remedies({"a shorter dt", "a larger cfl, which takes fewer substeps", "fewer cells"});

  start_.add({"position", "m", Scalar::f64, 3, Role::position}, rows_);
  velocity_ = start_.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, rows_);
  if (def.advection == GridFluidDef::Advection::apic) {
    const auto square = static_cast<uint32_t>(g.dimensions * g.dimensions);
    affine_ = start_.add({"affine", "1/s", Scalar::f64, square}, rows_);
  }
  pressure_ = start_.add({"pressure", "m^2/s^2"}, g.size());
  fill_ = start_.add({"fill", "1"}, g.size());
  numbers_ = start_.add({"numbers", "1"}, kNumbers);
  const auto x = start_.f64(kPosition), v = start_.f64(velocity_);
  const double t = 0;
  for (size_t i = 0; i < rows_; ++i) {
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
            std::to_string(rows_) + " particles through " + std::to_string(g.cell_count()) + " cells, " +
                (apic ? "affine (APIC)" : "changes from the grid (FLIP)") +
                "; pressure and density by conjugate gradients and multigrid",
            [this](State& s, const StepInput& in) { advance(s, in); });
  if (def.obstacles.empty()) skip_stage("obstacles", "no obstacles given");
  if (def.viscosity == 0) skip_stage("viscosity", "viscosity is 0");
  if (!model_.texts.forced) skip_stage("force", "no force but gravity given");
}

LiquidFields Liquid::fields(State& s) const {
  LiquidFields f;
  f.rows = rows_;
  f.position = s.f64(kPosition).data(), f.velocity = s.f64(velocity_).data();
  if (affine_) f.affine = s.f64(affine_).data();
  f.pressure = s.f64(pressure_).data(), f.fill = s.f64(fill_).data();
  return f;
}

void Liquid::advance(State& s, const StepInput& in) const {
  auto& flow = in.workspace.object<LiquidFlow>("grid_fluid.liquid");
  flow.bind(model_, rows_, in.arena);
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
  for (int i = 0; i < n; ++i) report = flow.substep(f, in.t + i * h, h);
  const double end = flow.crossing_rate(in.t + in.h);
  flow.store(f);
  const auto numbers = s.f64(numbers_);
  numbers[kSubsteps] = n, numbers[kCfl] = std::max(start, end) * h;
  numbers[kIterations] = report.pressure.iterations, numbers[kResidual] = report.pressure.residual;
  numbers[kDensityIterations] = report.density.iterations;
  numbers[kMeanCompression] = report.mean_compression, numbers[kMaxCompression] = report.max_compression;
}

FieldView Liquid::field(const State& s, size_t, size_t field, std::vector<double>& scratch) const {
  const double* x = s.f64(kPosition).data();
  if (field == 0) return {x, Scalar::f64, rows_, 3};
  const double* v = s.f64(velocity_).data();
  if (field == 1) return {v, Scalar::f64, rows_, 3};
  scratch.resize(rows_);
  const mac::MacGrid& g = model_.grid;
  const double* of_cells = s.f64(field == 3 ? pressure_ : fill_).data();
  const double scale = field == 3 ? model_.def.density : 1;
  for (size_t i = 0; i < rows_; ++i) {
    if (field == 2) {
      scratch[i] = norm(load3(v, i));
      continue;
    }
    size_t cell[3] = {};
    for (size_t a = 0; a < g.dimensions; ++a) {
      const double place = (x[3 * i + a] - g.origin[a]) / g.spacing[a];
      cell[a] = static_cast<size_t>(std::clamp(place, 0.0, static_cast<double>(g.cells[a] - 1)));
    }
    scratch[i] = scale * of_cells[g.at(cell[0], cell[1], cell[2])];
  }
  return {scratch.data(), Scalar::f64, rows_, 1};
}

void Liquid::observe(const State& s, double, Observables& out) const {
  const double *x = s.f64(kPosition).data(), *v = s.f64(velocity_).data();
  double kinetic = 0, height = 0, fastest = 0;
  Vec3 p, centre, low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
  for (size_t i = 0; i < rows_; ++i) {
    const Vec3 at = load3(x, i), u = load3(v, i);
    kinetic += 0.5 * mass_ * norm2(u), height -= mass_ * dot(model_.gravity, at);
    fastest = std::max(fastest, norm2(u));
    p += u * mass_, centre += at;
    low = {std::min(low.x, at.x), std::min(low.y, at.y), std::min(low.z, at.z)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y), std::max(high.z, at.z)};
  }
  out.add("energy.kinetic", kinetic, "J");
  out.add("energy.gravity", height, "J");
  out.add("energy.total", kinetic + height, "J");
  const auto add = [&](const std::string& name, const Vec3& a, const char* unit) {
    out.add(name + ".x", a.x, unit), out.add(name + ".y", a.y, unit), out.add(name + ".z", a.z, unit);
  };
  const auto n = static_cast<double>(rows_);
  add("momentum", p, "kg m/s");
  add("centre", centre / n, "m");
  add("low", low, "m");
  add("high", high, "m");
  out.add("mass", mass_ * n, "kg");
  out.add("speed.max", std::sqrt(fastest), "m/s");
  const auto numbers = s.f64(numbers_);
  out.add("density.mean_error", numbers[kMeanCompression], "1");
  out.add("density.max_error", numbers[kMaxCompression], "1");
  out.add("cfl", numbers[kCfl], "1");
  out.add("substeps", numbers[kSubsteps], "1");
  out.add("pressure.iterations", numbers[kIterations], "1");
  out.add("pressure.residual", numbers[kResidual], "1");
  out.add("density.iterations", numbers[kDensityIterations], "1");
}

void Liquid::draw(const State&, double t, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::constant)) {
    const mac::MacGrid& g = model_.grid;
    out.parts.resize(parts().size());
    out.parts[0].point_radius = 0.5 * g.spacing[0] / model_.def.particles_per_axis;
    if (g.dimensions == 2) {
      for (PartDrawing& part : out.parts) part.space = PartDrawing::Space::plane;
    }
  }
  if (!wants(wishes, Wish::obstacles)) return;
  ObstaclePlaces now;
  model_.texts.place_obstacles(model_.def.obstacles, t, now);
  draw_obstacles(now.obstacles, out);
}

void Liquid::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind != CommandKind::impulse)
    refuse_command("type", "unsupported_command", "a liquid on a grid takes no such command", "impulse");
  refuse_place(c, "particle");
  const size_t row = checked_command_row(c, rows_, "particle");
  if (model_.grid.dimensions == 2 && c.vector.z != 0)
    refuse_command("vector", "out_of_range", "a plane liquid must stay in z = 0");
  double* v = s.f64(velocity_).data();
  store3(v, row, load3(v, row) + c.vector / mass_);
}

void Liquid::warn(const State& s, double h, std::vector<Warning>& out) const {
  const auto numbers = s.f64(numbers_);
  warn_of_crossing(numbers[kCfl], kMostTraced, h / std::max(1.0, numbers[kSubsteps]), out);
  // Twice the mean of a dam break at its thinnest.
  constexpr double kMostCompressed = 0.05;
  if (!(numbers[kMeanCompression] > kMostCompressed)) return;
  out.push_back({.quantity = "density.mean_error",
                 .value = numbers[kMeanCompression],
                 .limit = kMostCompressed,
                 .detail = "cells hold " + short_number(100 * numbers[kMeanCompression]) +
                           " % more liquid than fits into them: more cells or a smaller cfl would do"});
}

}  // namespace truestep::grid_fluid
