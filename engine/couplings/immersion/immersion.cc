#include "engine/couplings/immersion/immersion.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/base/errors.h"
#include "engine/collision/point_distance.h"
#include "engine/couplings/exchange.h"
#include "engine/geometry/solid.h"

namespace truestep::immersion {

const DefTable& immersion_table() {
  using D = ImmersionDef;
  static const DefTable t = TableOf<D>("rigid bodies of a float, sink and are carried in b, a medium")
                                .choice("bodies", &D::bodies, {"moving", "all"},
                                        "all: also static ones; planes and height fields never are")
                                .build();
  return t;
}

Cost immersion_cost(const void*, const Cost& a, const Cost&) {
  return {.state_bytes = 64 + 32 * a.elements,
          .workspace_bytes = 600 * a.elements,
          .elements = a.elements,
          .seconds_per_step = 2e-7 * a.elements};
}

namespace {

/// Greatest initial depth of a parcel in a body, in spacings: a parcel's surface is half a spacing from its
/// centre.
constexpr double kDeepest = 0.5;
/// Longest free fall in a substep, in spacings. Crates in water of particles of 6 cm come to rest at their
/// levels with falls up to 0.2, a centimetre or two off at 0.4, some on the floor at 0.8, and are thrown out
/// at 13.
constexpr double kLongestFall = 0.1;
constexpr State::Column kPull = exchange_columns::end, kImpulse = kPull + 1, kTwist = kPull + 2,
                        kIds = kPull + 3;

class Immersion final : public Coupling {
 public:
  Immersion(const ImmersionDef& def, const BodyPort& bodies, size_t count, const CouplingContext& context)
      : def_(def),
        port_(bodies),
        count_(count),
        name_(context.b.id),
        medium_(*context.b.system.ports().medium) {}

  /// The action of the medium and of everything else on the initial bodies in the last step; for other bodies
  /// it is unknown.
  State initial_state() const override {
    State s = exchange_state();
    s.add({"pull", "m/s^2", Scalar::f64, 3}, count_);
    s.add({"last_impulse", "N s", Scalar::f64, 3}, count_);
    s.add({"last_twist", "N m s", Scalar::f64, 3}, count_);
    s.add({"ids", "1", Scalar::u64}, count_);
    for (uint64_t& id : s.span<uint64_t>(kIds)) id = kNobody;
    return s;
  }
  bool takes(const ConstBodies& bodies, size_t i) const {
    const BodyForm& form = bodies.form(i);
    if (!form.solid || form.solid->kind == SolidKind::plane || form.solid->kind == SolidKind::height_field)
      return false;
    const bool still = norm2(bodies.velocity(i)) + norm2(bodies.spin(i)) == 0;
    return def_.bodies == ImmersionDef::Which::all || bodies.dynamic(i) || !still;
  }
  /// Half of what the medium did in the previous step, so that contacts take it into account.
  void begin(const CoupledStates& s, const StepInput&) const override {
    Bodies bodies(s.a, port_);
    for (size_t i = 0; i < std::min(count_, bodies.count()); ++i) {
      const Given half = last(s.own, bodies, i) * 0.5;
      if (!half.none()) bodies.push_and_turn(i, half.impulse, half.twist);
    }
  }

  void immerse(const ConstCoupledStates& s, const StepInput& in,
               std::vector<ImmersedBody>& out) const override {
    auto& scratch = in.workspace.object<Scratch>("immersion");
    const ConstBodies bodies(s.a, port_);
    const auto pull = s.own.f64(kPull);
    const auto ids = s.own.span<uint64_t>(kIds);
    scratch.rows.clear(), scratch.velocity.clear();
    for (size_t i = 0; i < bodies.count(); ++i) {
      if (!takes(bodies, i)) continue;
      const BodyForm& form = bodies.form(i);
      ImmersedBody& b = out.emplace_back();
      b.solid = form.solid, b.mass = form.mass, b.moments = form.moments;
      b.place = bodies.place(i), b.orientation = bodies.orientation(i);
      b.velocity = bodies.velocity(i), b.spin = bodies.spin(i);
      scratch.velocity.push_back(b.velocity);
      scratch.rows.push_back(i);
      if (i >= count_ || ids[i] != bodies.id_of(i)) continue;
      b.pull = load3(pull.data(), i);
      const Given half = last(s.own, bodies, i) * 0.5;
      const auto by = b.answer(half.impulse, half.twist);
      b.velocity -= by.velocity, b.spin -= by.spin;
    }
  }

  void emerge(const CoupledStates& s, const StepInput& in,
              std::span<const ImmersedBody> given) const override {
    const auto& scratch = in.workspace.object<Scratch>("immersion");
    Bodies bodies(s.a, port_);
    const auto pull = s.own.f64(kPull);
    const auto impulses = s.own.f64(kImpulse), twists = s.own.f64(kTwist);
    const auto ids = s.own.span<uint64_t>(kIds);
    Exchange sum;
    for (size_t k = 0; k < given.size(); ++k) {
      const size_t i = scratch.rows[k];
      const ImmersedBody& b = given[k];
      if (!bodies.dynamic(i)) {
        sum.add(-b.impulse, 0);
        continue;
      }
      if (i < count_) {
        store3(pull.data(), i, (bodies.velocity(i) - scratch.velocity[k]) / in.h);
      }
      const Given before = last(s.own, bodies, i), now{b.impulse, b.twist};
      if (i < count_) {
        ids[i] = bodies.id_of(i);
        store3(impulses.data(), i, now.impulse), store3(twists.data(), i, now.twist);
      }
      if (before.none() && now.none()) continue;
      sum.add(-b.impulse, 0);
      const Given rest = now + before * -0.5, more = now + before * -1;
      bodies.push_and_turn(i, rest.impulse, rest.twist);
      // As by a force that lasts through the step.
      const auto by = b.answer(more.impulse, more.twist);
      bodies.move(i, by.velocity * (0.5 * in.h), by.spin * (0.5 * in.h));
    }
    book(s.own, sum);
  }
  void end(const CoupledStates&, const StepInput&) const override {}

  std::optional<double> stable_h(const ConstCoupledStates& s) const override {
    double gravity = norm(load3(s.b.f64(medium_.gravity).data(), 0));
    if (port_.gravity) gravity = std::max(gravity, norm(load3(s.a.f64(*port_.gravity).data(), 0)));
    if (!(gravity > 0)) return std::nullopt;
    return std::sqrt(2 * kLongestFall * medium_.spacing / gravity);
  }

  void observe(const ConstCoupledStates& s, Observables& out) const override { observe_impulses(s.own, out); }
  std::vector<PlanRow> plan() const override {
    return {{PlanRow::Status::runs, "bodies in the medium", name_ + " moves them itself"}};
  }

 private:
  static constexpr uint64_t kNobody = UINT64_MAX;
  /// N s and N m s given to a body by the medium in a step.
  struct Given {
    Vec3 impulse, twist;
    Given operator*(double f) const { return {impulse * f, twist * f}; }
    Given operator+(const Given& o) const { return {impulse + o.impulse, twist + o.twist}; }
    bool none() const { return norm2(impulse) + norm2(twist) == 0; }
  };
  template <class Real>
  Given last(const State& own, const BodiesOf<Real>& bodies, size_t i) const {
    if (i >= count_ || own.span<uint64_t>(kIds)[i] != bodies.id_of(i) || !bodies.dynamic(i)) return {};
    return {load3(own.f64(kImpulse).data(), i), load3(own.f64(kTwist).data(), i)};
  }
  struct Scratch {
    std::vector<size_t> rows;
    std::vector<Vec3> velocity;
  };
  ImmersionDef def_;
  BodyPort port_;
  size_t count_;
  std::string name_;  ///< of the medium
  MediumPort medium_;
};

/// Parcels of the medium deeper in a body than two touching parcels would be.
size_t parcels_in(const ConstBodies& bodies, size_t body, const State& medium, const MediumPort& port) {
  const Transform frame{rotation(bodies.orientation(body)), bodies.place(body)};
  const Solid& solid = *bodies.form(body).solid;
  const double reach = bounding_radius(solid), near = reach * reach;
  const MeshSides sides = mesh_sides(solid);
  const RealColumn<const double> places(medium, port.place);
  size_t out = 0;
  for (size_t k = 0; k < medium.rows(port.place); ++k) {
    const Vec3 p = places.vector(k);
    if (norm2(p - frame.position) > near) continue;
    const auto at = point_distance(solid, frame.inverse_point(p), reach, sides);
    if (at && at->distance < -kDeepest * port.spacing) ++out;
  }
  return out;
}

[[noreturn]] void refuse(const std::string& member, const std::string& id, const std::string& why,
                         const std::string& allowed) {
  throw Error("scene_invalid", '"' + id + "\" " + why,
              {"/" + member, "unsuitable_system", '"' + id + "\" " + why, '"' + id + '"', allowed, "", ""});
}

}  // namespace

std::unique_ptr<const Coupling> build_immersion(const void* def, const CouplingContext& context) {
  const Ports a = context.a.system.ports(), b = context.b.system.ports();
  if (!a.bodies || a.bodies->access())
    refuse("a", context.a.id, "has no rigid bodies in space", "a system of type rigid3d");
  if (!b.medium) {
    refuse("b", context.b.id, "is not a medium that takes bodies",
           "a system of type mpm, or sph with a single density and no solved viscosity at no_slip walls");
  }
  if (b.medium->dimension != 3) refuse("b", context.b.id, "is a medium in the plane", "dimension 3");
  const ConstBodies bodies(context.a.state, *a.bodies);
  auto out = std::make_unique<const Immersion>(*static_cast<const ImmersionDef*>(def), *a.bodies,
                                               bodies.count(), context);
  for (size_t i = 0; i < bodies.count(); ++i) {
    if (!out->takes(bodies, i)) continue;
    const size_t drowned = parcels_in(bodies, i, context.b.state, *b.medium);
    if (drowned == 0) continue;
    const std::string what = "starts with " + std::to_string(drowned) + " of its particles inside body " +
                             std::to_string(i) + " of \"" + context.a.id + '"';
    refuse("b", context.b.id, what, "a medium that leaves room for the bodies: \"hollows\" of a fluid");
  }
  return out;
}

}  // namespace truestep::immersion
