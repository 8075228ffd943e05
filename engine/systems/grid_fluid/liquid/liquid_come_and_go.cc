// Particles of a liquid that come in through nozzles and sides of kind inflow, and those that are removed: in
// kill regions, and beyond open sides.
#include <algorithm>
#include <cmath>

#include "engine/systems/grid_fluid/liquid/liquid.h"

namespace truestep::grid_fluid {

namespace {
/// Minimum distance of a nozzle's new particle from existing ones: what is in the nozzle moves on, and what
/// lies behind it is no reason to pour less.
constexpr double kRoom = 0;
}  // namespace

void Liquid::come_and_go(State& s, const StepInput& in, const GivenFlow& given, double t, double h) const {
  remove_gone(s, in);
  feed(s, in.workspace, given, t, h);
  pour(s, t + h, in.workspace);
}

void Liquid::append(State& s, const Vec3& at, const Vec3& velocity, double dye) const {
  const size_t row = rows(s);
  const auto counts = s.span<uint64_t>(counts_);
  if (row >= capacity_) {
    ++counts[kRefused];
    return;
  }
  for_particle_columns([&](State::Column c) { s.resize(c, row + 1); });
  store3(s.f64(kPosition).data(), row, at), store3(s.f64(velocity_).data(), row, velocity);
  if (affine_) {
    const size_t square = s.info(affine_).width;
    std::fill_n(s.f64(affine_).data() + square * row, square, 0.0);
  }
  if (dye_) s.f64(dye_)[row] = dye;
  s.span<uint64_t>(id_column_)[row] = counts[kBorn]++;
  ++counts[kEmitted];
}

void Liquid::pour(State& s, double t, Workspace& workspace) const {
  auto& near = workspace.object<std::vector<Vec3>>("grid_fluid.near_nozzle");
  for (size_t k = 0; k < inlets_.size(); ++k) {
    const LiquidInlet& inlet = inlets_[k];
    uint64_t& next = s.span<uint64_t>(layers_)[k];
    inlet.pour(s, kPosition, next, t, kRoom, near,
               [&](const Vec3& p) { append(s, p, inlet.velocity(), inlet.dye); });
  }
}

Vec3 Liquid::side_velocity(const GivenFlow::Side& side, double t, const Vec3& at) const {
  double u[3] = {};
  for (size_t c = 0; c < model_.grid.dimensions; ++c) {
    const ExpressionRows::Column in[] = {{&t, 0}, {&at.x, 0}, {&at.y, 0}, {&at.z, 0}};
    const ExpressionRows::Output to[] = {{&u[c], 1}};
    model_.texts.sides[side.axis][side.end][c].rows.run(in, to, 0, 1);
  }
  return {u[0], u[1], u[2]};
}

// A face takes in particles_per_axis^(d-1) rows of particles; along a row they follow each other one spacing
// apart, so that what comes in has the density of liquid at rest.
void Liquid::feed(State& s, Workspace& workspace, const GivenFlow& given, double t, double h) const {
  const mac::MacGrid& g = model_.grid;
  const auto per = static_cast<size_t>(model_.def.particles_per_axis);
  const double spacing = g.spacing[0] / static_cast<double>(per);
  size_t site = 0;
  auto& now = workspace.object<ObstaclePlaces>("grid_fluid.beside_sides");
  if (!model_.def.obstacles.empty() && !given.sides().empty())
    model_.texts.place_obstacles(model_.def.obstacles, t + h, now);
  for (const GivenFlow::Side& side : given.sides()) {
    const size_t a = side.axis, first = a == 0 ? 1 : 0, second = a == 2 ? 1 : 2;
    const bool space = g.dimensions == 3;
    const double inwards = side.end == 0 ? 1 : -1;
    const double dye = side_of(model_.def, a, side.end).dye.value_or(0);
    for (size_t q = 0; q < (space ? per * g.cells[second] : 1); ++q) {
      for (size_t p = 0; p < per * g.cells[first]; ++p, ++site) {
        const size_t plane = p / per + mac::kGhosts + g.padded(first) * (space ? q / per + mac::kGhosts : 0);
        const double u = side.inwards(plane);
        double& phase = s.f64(phase_)[site];
        phase += std::max(u, 0.0) * h / spacing;
        for (; phase >= 1; phase -= 1) {
          double x[3] = {};
          x[a] = g.origin[a] + (side.end == 0 ? 0 : g.extent(a)) + inwards * (phase - 1) * spacing;
          x[first] = g.origin[first] + (static_cast<double>(p) + 0.5) * spacing;
          if (space) x[second] = g.origin[second] + (static_cast<double>(q) + 0.5) * spacing;
          const Vec3 at{x[0], x[1], x[2]};
          if (distance_to(now.obstacles, at, g.dimensions) <= 0) continue;
          append(s, at, side_velocity(side, t, at), dye);
        }
      }
    }
  }
}

void Liquid::remove_gone(State& s, const StepInput& in) const {
  const mac::MacGrid& g = model_.grid;
  auto& dead = in.workspace.object<std::vector<uint8_t>>("grid_fluid.dead");
  dead.reserve(capacity_);
  const uint64_t killed = find_killed(model_.def, s, kPosition, in.arena, dead);
  uint64_t left = 0;
  const double* x = s.f64(kPosition).data();
  for (size_t a = 0; a < g.dimensions; ++a) {
    const double low = g.origin[a], high = g.origin[a] + g.extent(a);
    for (size_t i = 0;
         i < dead.size() && (lets_through(model_.kinds[a][0]) || lets_through(model_.kinds[a][1])); ++i) {
      if (dead[i] || !(x[3 * i + a] < low || x[3 * i + a] > high)) continue;
      dead[i] = 1, ++left;
    }
  }
  if (killed + left == 0) return;
  auto& living = in.workspace.object<LivingRows>("grid_fluid.living");
  living.set(dead);
  for_particle_columns([&](State::Column c) { living.close(s, c); });
  s.span<uint64_t>(counts_)[kKilled] += killed, s.span<uint64_t>(counts_)[kLeft] += left;
}

void Liquid::check(StateCheck& check, double t) const {
  if (!counts_) return;
  constexpr uint64_t kMostBehind = 1000;  // layers overdue: in a run there are none, but times are rounded
  const State& s = check.state();
  for_particle_columns([&](State::Column c) { check.together({kPosition, c}, capacity_); });
  if (phase_) {
    const bool within = std::ranges::all_of(s.f64(phase_), [](double p) { return p >= 0 && p < 1; });
    check.require(within, "inflow.phase");
  }
  const auto next = s.span<uint64_t>(layers_);
  check.require(next.size() == inlets_.size(), "emitters");
  for (size_t k = 0; k < inlets_.size() && k < next.size(); ++k) {
    const bool near = next[k] <= UINT64_MAX / 2 && inlets_[k].birth(next[k] + kMostBehind) >= t;
    check.require(near, "an emitter is far behind the simulated time");
  }
}

}  // namespace truestep::grid_fluid
