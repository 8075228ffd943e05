#include "engine/systems/nbody/nbody.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/systems/nbody/collisions/impacts.h"
#include "engine/systems/nbody/hermite.h"
#include "engine/systems/nbody/mercurius.h"
#include "engine/systems/nbody/wisdom_holman.h"

namespace truestep::nbody {

namespace {

/// m, a dot as seen from where everything is in the picture. The bulk of the bodies decides, not the
/// farthest.
double dot_radius(const State& s) {
  const auto x = s.f64(Columns::position);
  const size_t n = x.size() / 3;
  Vec3 middle;
  for (size_t i = 0; i < n; ++i) middle += load3(x.data(), i) / static_cast<double>(n);
  std::vector<double> r;
  for (size_t i = 0; i < n; ++i) r.push_back(norm(load3(x.data(), i) - middle));
  std::nth_element(r.begin(), r.begin() + static_cast<ptrdiff_t>(9 * (n - 1) / 10), r.end());
  const double reach = r[9 * (n - 1) / 10];
  return (reach > 0 ? reach : 1) * (n <= kFewBodies ? 0.03 : n <= 1000 ? 0.012 : 0.006);
}

[[noreturn]] void refuse(std::string_view integrator, const std::string& why) {
  const std::string name(integrator);
  throw Error(
      "scene_invalid", "integrator " + name + ": " + why,
      {"/integrator", "unsuitable_integrator", why, '"' + name + '"', "ias15, leapfrog and others", "", ""});
}

/// Error "scene_invalid" when no body outweighs the others.
void check_sun(std::string_view integrator, const NbodyField& field) {
  const State s = field.initial_state();
  const auto mass = s.f64(Columns::mass);
  double others = 0;
  for (size_t i = 1; i < mass.size(); ++i) others += mass[i];
  if (mass.size() < 2 || !(mass[0] > 10 * others))
    refuse(integrator, "the first body must outweigh all others ten times");
}

/// Error "scene_invalid" if the method does not cover the scene.
void check_mercurius(const NbodyDef& def, const NbodyField& field) {
  check_sun(kMercuriusName, field);
  if (def.softening_kind == gravity::SofteningKind::spline && def.softening > 0)
    refuse(kMercuriusName, "it supports Plummer's softening, not the spline's");
  if (def.method != Method::automatic && def.method != Method::direct)
    refuse(kMercuriusName, "it sums over all pairs: method direct or auto");
  if (def.collisions) {
    refuse(kMercuriusName, "it does not stop where bodies collide: ias15 does");
  }
}

const Integrator& checked_hermite(const NbodyDef& def) {
  if (def.softening_kind == gravity::SofteningKind::spline && def.softening > 0)
    refuse(kHermiteName, "it supports Plummer's softening, not the spline's");
  if (def.method != Method::automatic && def.method != Method::direct)
    refuse(kHermiteName, "it sums over all pairs: method direct or auto");
  return hermite();
}

ChosenMethod method_of(const NbodyDef& def, const NbodyField& field, double dt) {
  if (def.integrator == kWisdomHolmanName) {
    check_sun(kWisdomHolmanName, field);
    return {wisdom_holman(), "named by the scene"};
  }
  if (def.integrator == kMercuriusName) {
    check_mercurius(def, field);
    return {mercurius(), "named by the scene"};
  }
  if (def.integrator == kHermiteName) return {checked_hermite(def), "named by the scene"};
  const size_t n = body_count(def);
  const bool few = n <= kFewBodies;
  if (def.integrator == "ias15" && chosen_method(def, n) != Method::direct) {
    refuse("ias15",
           "it finds its step to rounding, which forces summed approximately never reach: method direct or "
           "auto");
  }
  return settle_method(def.choice(), {.usual = few ? "ias15" : "leapfrog"}, field, dt);
}

IntegratorOptions options_of(const NbodyDef& def, const ChosenMethod& method) {
  constexpr double kAarseth = 0.01;  // eta, the usual value
  IntegratorOptions out = def.choice().options;
  if (def.integrator == kHermiteName) out.tolerance = def.tolerance.value_or(kAarseth);
  // To rounding through close encounters: a step's error is 5e-17 of it. The table's default loses 5e-9 of
  // the energy in one planetary encounter.
  constexpr double kRounding = 1e-14;
  if (method.row.name == "ias15" || method.row.name == kMercuriusName)
    out.tolerance = def.tolerance.value_or(kRounding);
  return out;
}

}  // namespace

Nbody::Nbody(std::unique_ptr<const NbodyField> field, const ChosenMethod& method, const NbodyDef& def)
    : Tabled(std::move(field), method.row, options_of(def, method)),
      bodies_(static_cast<const NbodyField&>(force_field())),
      draw_radius_(def.draw_radius.value_or(dot_radius(bodies_.initial_state()))) {
  show();
  std::vector<std::string> remedies{"a shorter step, or ias15, which adapts its own"};
  if (def.softening == 0) remedies.push_back("softening, if each body represents many");
  set_remedies(std::move(remedies));
  plan_stages(method.why);
}

std::unique_ptr<const Nbody> Nbody::make(const NbodyDef& def, const BuildContext& context) {
  auto field = std::make_unique<const NbodyField>(def, context.seed);
  const ChosenMethod method = method_of(def, *field, context.dt);
  return std::unique_ptr<const Nbody>(new Nbody(std::move(field), method, def));
}

void Nbody::plan_stages(const std::string& why_this_method) {
  const NbodyDef& d = bodies_.def();
  const std::string sums = bodies_.attraction().reason(main_part().max_rows);
  const std::string why = why_this_method.empty() ? sums : why_this_method + "; " + sums;
  if (d.collisions) {
    add_stage("integrate",
              "advances position and velocity with " + std::string(integrator().name) +
                  ", each collision where its path touches: " + why,
              [this](State& s, const StepInput& in) {
                step_with_collisions(force_field(), integrator(), options(), *bodies_.def().collisions, s,
                                     in);
              });
  } else {
    add_integration_stage(why);
    skip_stage("collisions", "none given: bodies pass through each other");
  }
  add_stage("hands", "ends pushes whose duration is over", [](State& s, const StepInput& in) {
    Columns::kHands.count_down(s, in.h, [&](uint64_t id) { return row_of(s, id).has_value(); });
  });
}

void Nbody::check(StateCheck& check, double) const {
  check.together(Columns::position, Columns::per_body_end, parts()[0].max_rows)
      .together({Columns::push_id, Columns::push_force, Columns::push_remaining})
      .together({Columns::drag_id, Columns::drag_target, Columns::drag_stiffness});
}

void Nbody::draw(const State&, double, Wish wishes, Drawing& out) const {
  if (!wants(wishes, Wish::constant)) return;
  const NbodyDef& d = bodies_.def();
  PartDrawing& t = out.parts.emplace_back();
  t.point_radius = draw_radius_;
  if (d.color) t.color = {d.color->x, d.color->y, d.color->z};
}

Energy::Exchange Nbody::exchange(const State& s) const {
  return bodies_.def().collisions || Columns::kHands.any(s) ? Energy::Exchange::open
                                                            : Energy::Exchange::closed;
}

std::unique_ptr<const System> build_nbody(const void* def, const BuildContext& context) {
  return Nbody::make(*static_cast<const NbodyDef*>(def), context);
}

}  // namespace truestep::nbody
