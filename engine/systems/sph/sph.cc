#include "engine/systems/sph/sph.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/core/commands/command_checks.h"
#include "engine/core/state/real_column.h"

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
  const Scalar real = def.precision == Precision::f32 ? Scalar::f32 : Scalar::f64;
  PartInfo points;
  points.fields = {{"position", "m", real, 3, Meaning::position},
                   {"velocity", "m/s", real, 3, Meaning::velocity},
                   {"density", "kg/m^3"},
                   {"pressure", "Pa"},
                   {"speed", "m/s"}};
  points.max_rows = setting_->capacity;
  set_parts({std::move(points)});
  set_remedies({"a shorter step", "a larger spacing", "more max_substeps"});
}

namespace {

Vec3 reach_of(const BodyDef& b) {
  return b.shape == Shape::ball ? Vec3{b.radius, b.radius, b.radius} : b.half_extents;
}

/// Initial pressures of standing liquid: liquid on the side of the box to which gravity along an axis points,
/// or on another body that stands. Falling liquid has none.
class StandingLiquid {
 public:
  StandingLiquid(const SphDef& d, const Vec3& gravity) : def_(d) {
    const double g[3] = {gravity.x, gravity.y, gravity.z};
    for (int a = 1; a < 3; ++a) axis_ = std::abs(g[a]) > std::abs(g[axis_]) ? a : axis_;
    weight_ = std::abs(g[axis_]), up_ = g[axis_] < 0 ? 1 : -1;
    if (d.wraps(axis_) || norm(gravity) > weight_ * (1 + 1e-9)) weight_ = 0;
    const double floor = up_ > 0 ? along(d.low) : -along(d.high);
    stands_.resize(d.bodies.size());
    const auto bottom = [&](const BodyDef& b) { return up_ * along(b.center) - along(reach_of(b)); };
    const auto on = [&](double low, double high) { return std::abs(low - high) <= 0.5 * d.spacing; };
    for (size_t pass = 0; pass < d.bodies.size(); ++pass) {
      for (size_t k = 0; k < d.bodies.size(); ++k) {
        const double low = bottom(d.bodies[k]);
        bool held = on(low, floor);
        for (size_t j = 0; j < d.bodies.size() && !held; ++j) {
          held = stands_[j] && on(low, bottom(d.bodies[j]) + 2 * along(reach_of(d.bodies[j])));
        }
        stands_[k] = held;
      }
    }
  }
  /// Pa, weight of the liquid above a point in body k.
  double pressure(size_t k, const Vec3& place) const {
    double out = 0;
    for (size_t j = 0; j < def_.bodies.size() && stands_[k]; ++j) {
      const BodyDef& b = def_.bodies[j];
      const Vec3 from = place - b.center;
      const double half = half_height(b, from), above = std::min(half - up_ * along(from), 2 * half);
      if (stands_[j]) out += b.density.value_or(def_.density) * weight_ * std::max(above, 0.0);
    }
    return out;
  }

 private:
  double along(const Vec3& v) const { return axis_ == 0 ? v.x : axis_ == 1 ? v.y : v.z; }
  /// m, half the length of a line along gravity inside a body; 0 where it misses.
  double half_height(const BodyDef& b, const Vec3& from) const {
    if (b.shape == Shape::ball) {
      const double beside = norm2(from) - along(from) * along(from);
      return std::sqrt(std::max(b.radius * b.radius - beside, 0.0));
    }
    const Vec3& half = b.half_extents;
    const bool in_x = axis_ == 0 || std::abs(from.x) <= half.x,
               in_y = axis_ == 1 || std::abs(from.y) <= half.y;
    const bool in_z = axis_ == 2 || def_.dimension == 2 || std::abs(from.z) <= half.z;
    return in_x && in_y && in_z ? along(half) : 0;
  }
  const SphDef& def_;
  int axis_ = 0;
  double weight_ = 0, up_ = 1;
  std::vector<char> stands_;
};

/// Relative density of Tait's equation at this pressure over density (m^2/s^2): a seventh root by Newton's
/// method.
double density_at(double pressure, double sound) {
  const double power = 1 + 7 * pressure / (sound * sound);
  double out = power;
  for (int k = 0; k < 200; ++k) {
    const double cube = out * out * out, next = out - (cube * cube * out - power) / (7 * cube * cube);
    if (!(next < out)) break;
    out = next;
  }
  return out;
}

}  // namespace

State Sph::initial_state() const {
  const SphDef& d = setting_->def;
  const size_t n = setting_->rows;
  const Scalar real = d.precision == Precision::f32 ? Scalar::f32 : Scalar::f64;
  State s;
  s.add({"position", "m", real, 3, Role::position}, n);
  s.add({"velocity", "m/s", real, 3, Role::velocity}, n);
  s.add({"density", "1", real}, n);
  s.add({"pressure", "Pa", real}, n);
  s.add({"push", "m^2/s^2", real}, n);
  s.add({"flow", "m^2/s^2", real}, n);
  s.add({"gravity", "m/s^2", Scalar::f64, 3}, 1);
  s.add({"report", "1", Scalar::f64, static_cast<uint32_t>(report::count + (d.solves_viscosity() ? 1 : 0))},
        1);
  if (setting_->ratio) s.add({"ratio", "1", real}, n);
  if (setting_->counts) {
    s.add({"emitter.next_layer", "1", Scalar::u64}, setting_->inlets.size());
    s.add({"counts", "1", Scalar::u64}, counts::count);
    for (State::Column c = 0; c < columns::per_particle_end; ++c) s.reserve(c, setting_->capacity);
    if (setting_->ratio) s.reserve(setting_->ratio, setting_->capacity);
  }
  store3(s.f64(columns::gravity).data(), 0, gravity_);
  RealColumn<double> x(s, columns::position), v(s, columns::velocity), density(s, columns::density);
  const StandingLiquid standing(d, gravity_);
  size_t i = 0;
  for (size_t body = 0; body < d.bodies.size(); ++body) {
    const BodyDef& b = d.bodies[body];
    for (const Vec3& place : wet_places(*setting_, b)) {
      const Vec3 r = place - b.center;
      x.set_vector(i, place);
      v.set_vector(i, b.velocity + cross(b.spin, r) +
                          Vec3{b.strain.x * r.x, b.strain.y * r.y, b.strain.z * r.z} +
                          setting_->initial_at(place));
      // Standing water would ring for seconds if its weight had to compress it first.
      const bool carried = d.solver == Method::wcsph;
      density.set(i, carried ? density_at(standing.pressure(body, place) / d.density, setting_->sound) : 1);
      if (setting_->ratio)
        RealColumn<double>(s, setting_->ratio).set(i, b.density.value_or(d.density) / d.density);
      ++i;
    }
  }
  return s;
}

Ports Sph::ports() const {
  const SphDef& d = setting_->def;
  // The coupling with bodies assumes a single density, and drag that is not part of a solve.
  if (d.layered() || (d.solves_viscosity() && d.walls == Walls::no_slip)) return {};
  return {.medium = MediumPort{d.dimension, columns::position, d.spacing, columns::gravity}};
}

FieldView Sph::field(const State& s, size_t, size_t which, std::vector<double>& scratch) const {
  const size_t n = s.rows(columns::position);
  const auto inside = [&](State::Column c) {
    return FieldView{s.bytes(c).data(), s.info(c).type, n, s.info(c).width};
  };
  if (which == 0) return inside(columns::position);
  if (which == 1) return inside(columns::velocity);
  if (which == 3) {
    solver_->read_pressures(s, scratch);
    return {scratch.data(), Scalar::f64, n, 1};
  }
  scratch.resize(n);
  const RealColumn<const double> v(s, columns::velocity), density(s, columns::density);
  for (size_t i = 0; i < n; ++i) {
    scratch[i] =
        which == 2 ? setting_->def.density * setting_->ratio_of(s, i) * density.at(i) : norm(v.vector(i));
  }
  return {scratch.data(), Scalar::f64, n, 1};
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
