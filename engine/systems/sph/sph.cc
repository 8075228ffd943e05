#include "engine/systems/sph/sph.h"

#include "engine/core/command_checks.h"
#include "engine/core/real_column.h"

namespace truestep::sph {

Sph::Sph(const SphDef& def, const BuildContext& context)
    : gravity_(context.gravity),
      setting_(settle(def, context.id, context.gravity)),
      solver_(make_solver(*setting_)) {
  if (def.dimension == 2) gravity_.z = 0;
  const char* why = def.solver == Method::dfsph
                        ? "no divergence, forces, density at rest: as many as the fastest particle asks for"
                        : "pressure by density, explicit: as many as sound asks for";
  add_stage("substeps", why, [this](State& s, const StepInput& in) { solver_->step(s, in); });
  if (def.colliders.empty()) skip_stage("colliders", "none given");
  const Scalar real = def.precision == Precision::f32 ? Scalar::f32 : Scalar::f64;
  PartInfo points;
  points.fields = {{"position", "m", real, 3, Meaning::position},
                   {"velocity", "m/s", real, 3, Meaning::velocity},
                   {"density", "kg/m^3"},
                   {"pressure", "Pa", real},
                   {"speed", "m/s"}};
  points.max_rows = setting_->rows;
  set_parts({std::move(points)});
}

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
  s.add({"report", "1", Scalar::f64, static_cast<uint32_t>(report::count)}, 1);
  store3(s.f64(columns::gravity).data(), 0, gravity_);
  RealColumn<double> x(s, columns::position), v(s, columns::velocity), density(s, columns::density);
  size_t i = 0;
  for (const BodyDef& b : d.bodies) {
    for (const Vec3& place : places_of(d, b)) {
      const Vec3 r = place - b.center;
      x.set_vector(i, place);
      v.set_vector(
          i, b.velocity + cross(b.spin, r) + Vec3{b.strain.x * r.x, b.strain.y * r.y, b.strain.z * r.z});
      density.set(i++, 1);
    }
  }
  return s;
}

Ports Sph::ports() const {
  const SphDef& d = setting_->def;
  return {.medium = MediumPort{d.dimension, columns::position, d.spacing}};
}

FieldView Sph::field(const State& s, size_t, size_t which, std::vector<double>& scratch) const {
  const size_t n = setting_->rows;
  const auto inside = [&](State::Column c) {
    return FieldView{s.bytes(c).data(), s.info(c).type, n, s.info(c).width};
  };
  if (which == 0) return inside(columns::position);
  if (which == 1) return inside(columns::velocity);
  if (which == 3) return inside(columns::pressure);
  scratch.resize(n);
  const RealColumn<const double> v(s, columns::velocity), density(s, columns::density);
  for (size_t i = 0; i < n; ++i) {
    scratch[i] = which == 2 ? setting_->def.density * density.at(i) : norm(v.vector(i));
  }
  return {scratch.data(), Scalar::f64, n, 1};
}

void Sph::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  const bool plane = setting_->def.dimension == 2;
  if (c.kind == CommandKind::impulse) {
    refuse_place(c, "particle");
    const size_t row = checked_command_row(c, setting_->rows, "particle");
    if (plane && c.vector.z != 0) {
      refuse_command("vector", "out_of_range", "a plane fluid stays in z = 0");
    }
    RealColumn<double> v(s, columns::velocity);
    v.set_vector(row, v.vector(row) + c.vector / setting_->mass);
    return;
  }
  if (c.kind != CommandKind::set_parameter) {
    refuse_command("kind", "not_supported", "particles of fluid take impulses and parameters alone",
                   "impulse, set_parameter");
  }
  if (c.name != "gravity") {
    refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set", "gravity");
  }
  Vec3 g = c.vector;
  if (plane) g.z = 0;
  store3(s.f64(columns::gravity).data(), 0, g);
}

void Sph::draw(const State&, double t, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::obstacles)) out.obstacles = setting_->colliders.drawn(t);
  if (!wants(wishes, Wish::constant)) return;
  PartDrawing& d = out.parts.emplace_back();
  d.point_radius = 0.5 * setting_->def.spacing;
  if (setting_->def.dimension == 2) d.space = PartDrawing::Space::plane;
}

std::vector<std::string> Sph::remedies() const {
  return {"a shorter step", "a larger spacing", "more max_substeps"};
}

std::unique_ptr<const System> build_sph(const void* def, const BuildContext& context) {
  return std::make_unique<const Sph>(*static_cast<const SphDef*>(def), context);
}

}  // namespace truestep::sph
