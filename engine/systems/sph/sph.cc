#include "engine/systems/sph/sph.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/text/short_number.h"
#include "engine/core/commands/command_checks.h"
#include "engine/core/state/real_column.h"
#include "engine/systems/sph/start.h"

namespace truestep::sph {

Sph::Sph(const SphDef& def, const BuildContext& context)
    : gravity_(context.gravity),
      dt_(context.dt),
      setting_(settle(def, context.id, context.gravity)),
      solver_(make_solver(*setting_)) {
  if (def.dimension == 2) gravity_.z = 0;
  const char* why =
      def.solver == Method::dfsph
          ? "zero divergence, forces, constant density: as many as the fastest particle requires"
          : "pressure from density, explicit: as many as sound waves require";
  add_stage("substeps", why, [this](State& s, const StepInput& in) { solver_->step(s, in); });
  if (def.any_regions()) {
    add_stage("removal", "kill regions",
              [this](State& s, const StepInput& in) { remove_killed(*setting_, s, in); });
  } else {
    skip_stage("removal", "no kill regions given");
  }
  if (def.emitters.empty()) skip_stage("births", "no emitters given");
  if (setting_->shifting == 0) skip_stage("shifting", "not asked for, and the liquid can part");
  if (def.surface_tension == 0) skip_stage("surface tension", "it is 0");
  if (def.colliders.empty()) skip_stage("colliders", "none given");
  show();
  if (def.settle > 0) {
    start_ = start_of(*setting_, gravity_);
    come_to_rest(*setting_, gravity_, dt_, *start_);
  } else {
    skip_stage("settling", "not asked for");
  }
  set_remedies({"a shorter step", "a larger spacing", "more max_substeps"});
}

std::optional<double> Sph::limit(Limit which, const State&, double h) const {
  if (which != Limit::step_seconds) return std::nullopt;
  // The speed of sound is ten times the largest speed that is expected; half of that is reached as a rule.
  const double speed = setting_->sound_for(gravity_) / 20;
  return sph_step_seconds(setting_->def, h, speed, setting_->sound, norm(gravity_));
}

std::vector<PlanRow> Sph::plan() const {
  std::vector<PlanRow> rows = StagedSystem::plan();
  const double settle = setting_->def.settle;
  if (settle > 0) {
    rows.insert(rows.begin(), {PlanRow::Status::runs, "settling",
                               "once, before time starts: " + short_number(settle, 3) + " s of steps"});
  }
  return rows;
}

State Sph::initial_state() const {
  return start_ ? *start_ : start_of(*setting_, gravity_);
}

Ports Sph::ports() const {
  const SphDef& d = setting_->def;
  // The coupling with bodies assumes a single density, and drag that is not part of a solve.
  if (d.layered() || (d.solves_viscosity() && d.walls == Walls::no_slip)) return {};
  return {.medium = MediumPort{d.dimension, columns::position, d.spacing, columns::gravity}};
}

void Sph::check(StateCheck& check, double t) const {
  const Setting& set = *setting_;
  if (!set.counts) return;
  constexpr uint64_t kMostBehind = 1000;  // layers overdue: in a run there are none, but times are rounded
  const State& s = check.state();
  check.together(columns::position, columns::per_particle_end, set.capacity);
  if (set.ratio) check.together({columns::position, set.ratio}, set.capacity);
  const auto next = s.span<uint64_t>(set.layers);
  check.require(next.size() == set.inlets.size(), "emitters");
  for (size_t k = 0; k < set.inlets.size() && k < next.size(); ++k) {
    const bool near = next[k] <= UINT64_MAX / 2 && set.inlets[k].birth(next[k] + kMostBehind) >= t;
    check.require(near, "an emitter is far behind the simulated time");
  }
}

void Sph::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  const bool plane = setting_->def.dimension == 2;
  if (c.kind == CommandKind::impulse) {
    refuse_place(c, "particle");
    const size_t row = checked_command_row(c, s.rows(columns::position), "particle");
    if (plane && c.vector.z != 0) {
      refuse_command("vector", "out_of_range", "a plane fluid must stay in z = 0");
    }
    RealColumn<double> v(s, columns::velocity);
    v.set_vector(row, v.vector(row) + c.vector / (setting_->mass * setting_->ratio_of(s, row)));
    return;
  }
  if (c.kind != CommandKind::set_parameter) {
    refuse_command("type", "unsupported_command", "fluid particles take only impulses and parameters",
                   "impulse, set_parameter");
  }
  if (c.name != "gravity") {
    refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set", "gravity");
  }
  Vec3 g = c.vector;
  if (plane) g.z = 0;
  store3(s.f64(columns::gravity).data(), 0, g);
}

namespace {

/// Adds the images of colliders at rest that reach into the box.
void draw_images(const Setting& set, std::vector<DrawnShape>& out) {
  const auto add = [&](const DrawnShape& solid, const Images& images, double radius) {
    each_in_box(set.def, images, solid.position, radius, [&](const Vec3& shift) {
      if (shift == Vec3{}) return;
      DrawnShape& image = out.emplace_back(solid);
      image.position += shift;
    });
  };
  const auto& colliders = set.colliders.colliders();
  for (size_t k = 0; k < colliders.size(); ++k) {
    if (colliders[k].motion.at_rest())
      add(DrawnShape(out[k]), set.images[k], bounding_radius(colliders[k].shape));
  }
  for (const MeshWall& m : set.meshes) {
    if (m.collider.motion.at_rest()) add(m.collider.drawn_at(0), m.images, m.radius);
  }
}

}  // namespace

void Sph::draw(const State&, double t, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::obstacles)) {
    out.obstacles = setting_->colliders.drawn(t);
    draw_images(*setting_, out.obstacles);
    for (const MeshWall& m : setting_->meshes) out.obstacles.push_back(m.collider.drawn_at(t));
  }
  if (!wants(wishes, Wish::constant)) return;
  PartDrawing& d = out.parts.emplace_back();
  d.point_radius = 0.5 * setting_->def.spacing;
  if (setting_->def.dimension == 2) d.space = PartDrawing::Space::plane;
}

std::unique_ptr<const System> build_sph(const void* def, const BuildContext& context) {
  return std::make_unique<const Sph>(*static_cast<const SphDef*>(def), context);
}

}  // namespace truestep::sph
