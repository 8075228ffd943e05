#include "engine/systems/mpm/mpm.h"

#include <algorithm>
#include <cmath>

#include "engine/core/commands/command_checks.h"

namespace truestep::mpm {

namespace {

std::unique_ptr<const Setting> settle(const MpmDef& def, const std::string& id) {
  auto out = std::make_unique<Setting>(Setting{.def = def,
                                               .pieces = {},
                                               .inlets = {},
                                               .colliders = build_colliders(def.colliders),
                                               .force = PlaceTexts(def.force, def.dimension, "/force"),
                                               .exact = PlaceTexts(def.exact, def.dimension, "/exact"),
                                               .id = id});
  size_t first = 0;
  const std::vector<int> fields = velocity_fields(def);
  out->fields = std::max<size_t>(fields.size(), 1);
  const auto add = [&](const MaterialDef& m, const Vec3& spacing, size_t count, const std::string& at) {
    const double volume = spacing.x * spacing.y * (def.dimension == 3 ? spacing.z : 1);
    const auto field = std::find(fields.begin(), fields.end(), m.velocity_field) - fields.begin();
    Piece p{material_of(m),
            static_cast<size_t>(field),
            spacing,
            m.density,
            volume * m.density,
            volume,
            first,
            first + count,
            nullptr};
    if (m.material == Law::elastic)
      p.energy = std::make_shared<const EnergyLaw>(m.energy, def.dimension, p.material, at + "/energy");
    out->pieces.push_back(std::move(p));
    first += count;
  };
  for (size_t k = 0; k < def.bodies.size(); ++k) {
    const BodyDef& b = def.bodies[k];
    const size_t count = places_of(def, b).size();
    // Boxes are divided evenly; particles of a ball each have the lattice's volume.
    add(b, spacing_of(def, b), count, "/bodies/" + std::to_string(k));
  }
  for (size_t k = 0; k < def.emitters.size(); ++k) {
    out->inlets.emplace_back(def, def.emitters[k]);
    const double s = def.spacing();
    add(def.emitters[k], {s, s, s}, 0, "/emitters/" + std::to_string(k));
  }
  out->capacity = largest_count(def, first);
  return out;
}

}  // namespace

Mpm::Mpm(const MpmDef& def, const BuildContext& context)
    : gravity_(context.gravity), setting_(settle(def, context.id)), solver_(make_solver(*setting_)) {
  if (def.dimension == 2) gravity_.z = 0;
  add_stage("substeps",
            def.is_implicit()
                ? "implicit, as many as the fastest particle requires: particles to grid and back"
                : "explicit, as many as the fastest particle or wave requires: particles to grid and back",
            [this](State& s, const StepInput& in) { solver_->step(s, in); });
  if (def.emitters.empty()) {
    skip_stage("births", "no emitters given");
  } else {
    add_stage("births", "layers of material from nozzles",
              [this](State& s, const StepInput& in) { pour(*setting_, s, in.t + in.h, in.workspace); });
  }
  if (def.any_regions()) {
    add_stage("removal", "kill regions",
              [this](State& s, const StepInput& in) { remove_killed(*setting_, s, in); });
  } else {
    skip_stage("removal", "no kill regions given");
  }
  if (def.colliders.empty()) skip_stage("colliders", "none given");
  if (setting_->fields == 1) skip_stage("contact of fields", "all material moves in one velocity field");
  if (def.force.empty()) skip_stage("force", "no acceleration is given");
  show();
  set_remedies({"a shorter step", "a softer material or a larger cell", "more max_substeps"});
}

namespace {

template <class T>
void fill(State& s, const Setting& set) {
  const auto x = s.span<T>(columns::position), v = s.span<T>(columns::velocity),
             c = s.span<T>(columns::affine), f = s.span<T>(columns::deformation),
             plastic = s.span<T>(columns::plastic), j = s.span<T>(columns::jacobian);
  const auto d = static_cast<size_t>(set.def.dimension);
  for (size_t b = 0; b < set.def.bodies.size(); ++b) {
    const BodyDef& body = set.def.bodies[b];
    const std::vector<Vec3> places = places_of(set.def, body);
    const double w[3] = {body.spin.x, body.spin.y, body.spin.z};
    for (size_t k = 0; k < places.size(); ++k) {
      const size_t i = set.pieces[b].first + k;
      const Vec3 u = body.velocity + cross(body.spin, places[k] - body.center);
      const double place[3] = {places[k].x, places[k].y, places[k].z}, speed[3] = {u.x, u.y, u.z};
      for (size_t a = 0; a < 3; ++a) {
        x[3 * i + a] = static_cast<T>(place[a]), v[3 * i + a] = a < d ? static_cast<T>(speed[a]) : T{0};
      }
      for (size_t a = 0; a < d; ++a) {
        f[d * d * i + d * a + a] = 1;
        // The gradient of a rigid rotation: the cross product with the spin.
        for (size_t e = 0; e < d; ++e) {
          if (a == e) continue;
          const double sign = (e + 1) % 3 == a ? 1 : -1;
          c[d * d * i + d * a + e] = static_cast<T>(sign * w[3 - a - e]);
        }
      }
      plastic[i] = body.material == Law::snow ? 1 : 0, j[i] = 1;
    }
  }
}

}  // namespace

State Mpm::initial_state() const {
  const Setting& set = *setting_;
  const size_t n = set.rows();
  const auto square = static_cast<uint32_t>(set.def.dimension * set.def.dimension);
  const Scalar real = set.def.precision == Precision::f32 ? Scalar::f32 : Scalar::f64;
  State s;
  s.add({"position", "m", real, 3, Role::position}, n);
  s.add({"velocity", "m/s", real, 3, Role::velocity}, n);
  s.add({"affine", "1/s", real, square}, n);
  s.add({"deformation", "1", real, square}, n);
  s.add({"plastic", "1", real}, n);
  s.add({"jacobian", "1", real}, n);
  s.add({"gravity", "m/s^2", Scalar::f64, 3}, 1);
  store3(s.f64(columns::gravity).data(), 0, gravity_);
  if (set.def.changes()) {
    s.add({"piece", "1", Scalar::u32}, n);
    s.add({"id", "1", Scalar::u64}, n);
    s.add({"emitter.next_layer", "1", Scalar::u64}, set.inlets.size());
    s.add({"counts", "1", Scalar::u64}, counts::count);
    for (size_t k = 0; k < n; ++k) {
      s.span<uint32_t>(columns::piece)[k] = set.piece_of(k, {});
      s.span<uint64_t>(columns::id)[k] = k;
    }
    s.span<uint64_t>(columns::counts)[counts::born] = n;
    for (State::Column c = 0; c < columns::per_particle_end; ++c) s.reserve(c, set.capacity);
    s.reserve(columns::piece, set.capacity), s.reserve(columns::id, set.capacity);
  }
  if (real == Scalar::f32) {
    fill<float>(s, set);
  } else {
    fill<double>(s, set);
  }
  return s;
}

void Mpm::check(StateCheck& check, double t) const {
  const Setting& set = *setting_;
  if (!set.def.changes()) return;
  constexpr uint64_t kMostBehind = 1000;  // layers; a run leaves none behind except by rounding
  const State& s = check.state();
  check.together(columns::position, columns::per_particle_end, set.capacity);
  check.together({columns::position, columns::piece, columns::id}, set.capacity);
  check.below(columns::piece, set.pieces.size());
  for (const uint32_t p : s.span<uint32_t>(columns::piece)) check.require(p < set.pieces.size(), "a piece");
  const auto next = s.span<uint64_t>(columns::layers);
  check.require(next.size() == set.inlets.size(), "emitters");
  for (size_t k = 0; k < set.inlets.size() && k < next.size(); ++k) {
    const bool near = next[k] <= UINT64_MAX / 2 && set.inlets[k].birth(next[k] + kMostBehind) >= t;
    check.require(near, "an emitter is far behind the simulated time");
  }
}

std::optional<double> Mpm::limit(Limit which, const State&, double h) const {
  return which == Limit::step_seconds ? std::optional(mpm_step_seconds(setting_->def, h)) : std::nullopt;
}

void Mpm::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind == CommandKind::impulse) {
    refuse_place(c, "particle");
    const size_t row = checked_command_row(c, s.rows(columns::position), "particle");
    if (setting_->def.dimension == 2 && c.vector.z != 0) {
      refuse_command("vector", "out_of_range", "a plane body must stay in z = 0");
    }
    RealColumn<double> v(s, columns::velocity);
    const Piece& piece = setting_->pieces[setting_->piece_of(row, setting_->pieces_of(s))];
    v.set_vector(row, v.vector(row) + c.vector / piece.mass);
    return;
  }
  if (c.kind != CommandKind::set_parameter) {
    refuse_command("type", "unsupported_command", "material particles take only impulses and parameters",
                   "impulse, set_parameter");
  }
  if (c.name != "gravity") {
    refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set", "gravity");
  }
  Vec3 g = c.vector;
  if (setting_->def.dimension == 2) g.z = 0;
  store3(s.f64(columns::gravity).data(), 0, g);
}

namespace {

/// The box that the material cannot leave.
DrawnShape walls_of(const MpmDef& def) {
  DrawnShape box;
  box.kind = DrawnShape::Kind::box, box.container = true, box.id = "walls";
  box.position = (def.low + def.high) * 0.5, box.size = (def.high - def.low) * 0.5;
  if (def.dimension == 2) box.position.z = 0, box.size.z = 0;
  return box;
}

}  // namespace

void Mpm::draw(const State&, double t, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::obstacles)) {
    out.obstacles = setting_->colliders.drawn(t);
    out.obstacles.push_back(walls_of(setting_->def));
  }
  if (!wants(wishes, Wish::constant)) return;
  PartDrawing& d = out.parts.emplace_back();
  d.point_radius = 0.5 * setting_->def.cell / setting_->def.particles_per_axis;
  if (setting_->def.dimension == 2) d.space = PartDrawing::Space::plane;
}

Ports Mpm::ports() const {
  const MpmDef& d = setting_->def;
  // The implicit solve does not include rigid bodies.
  if (d.is_implicit()) return {};
  return {.medium =
              MediumPort{d.dimension, columns::position, d.cell / d.particles_per_axis, columns::gravity}};
}

std::unique_ptr<const System> build_mpm(const void* def, const BuildContext& context) {
  return std::make_unique<const Mpm>(*static_cast<const MpmDef*>(def), context);
}

}  // namespace truestep::mpm
