#include "engine/couplings/immersion/immersion.h"

#include <string>
#include <utility>

#include "engine/base/errors.h"
#include "engine/couplings/exchange.h"
#include "engine/geometry/solid.h"

namespace truestep::immersion {

const DefTable& immersion_table() {
  using D = ImmersionDef;
  static const DefTable t =
      TableOf<D>("rigid bodies of a float, sink and are carried in b, a medium")
          .choice("bodies", &D::bodies, {"moving", "all"},
                  "all: also those that nothing moves; planes and height fields are never in it")
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

constexpr State::Column kPull = exchange_columns::end, kIds = kPull + 1;

class Immersion final : public Coupling {
 public:
  Immersion(const ImmersionDef& def, const BodyPort& bodies, size_t count, std::string medium)
      : def_(def), port_(bodies), count_(count), medium_(std::move(medium)) {}

  /// What else accelerates the bodies that there are at t = 0; of others it is not known.
  State initial_state() const override {
    State s = exchange_state();
    s.add({"pull", "m/s^2", Scalar::f64, 3}, count_);
    s.add({"ids", "1", Scalar::u64}, count_);
    for (uint64_t& id : s.span<uint64_t>(kIds)) id = kNobody;
    return s;
  }
  void begin(const CoupledStates&, const StepInput&) const override {}

  void immerse(const ConstCoupledStates& s, const StepInput& in,
               std::vector<ImmersedBody>& out) const override {
    auto& scratch = in.workspace.object<Scratch>("immersion");
    const ConstBodies bodies(s.a, port_);
    const auto pull = s.own.f64(kPull);
    const auto ids = s.own.span<uint64_t>(kIds);
    scratch.rows.clear(), scratch.velocity.clear();
    for (size_t i = 0; i < bodies.count(); ++i) {
      const BodyForm& form = bodies.form(i);
      if (!form.solid || form.solid->kind == SolidKind::plane || form.solid->kind == SolidKind::height_field)
        continue;
      const bool still = norm2(bodies.velocity(i)) + norm2(bodies.spin(i)) == 0;
      if (def_.bodies == ImmersionDef::Which::moving && !bodies.dynamic(i) && still) continue;
      ImmersedBody& b = out.emplace_back();
      b.solid = form.solid, b.mass = form.mass, b.moments = form.moments;
      b.place = bodies.place(i), b.orientation = bodies.orientation(i);
      b.velocity = bodies.velocity(i), b.spin = bodies.spin(i);
      if (i < ids.size() && ids[i] == bodies.id_of(i)) b.pull = load3(pull.data(), i);
      scratch.rows.push_back(i), scratch.velocity.push_back(b.velocity);
    }
  }

  void emerge(const CoupledStates& s, const StepInput& in,
              std::span<const ImmersedBody> given) const override {
    const auto& scratch = in.workspace.object<Scratch>("immersion");
    Bodies bodies(s.a, port_);
    const auto pull = s.own.f64(kPull);
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
        ids[i] = bodies.id_of(i);
        store3(pull.data(), i, (bodies.velocity(i) - scratch.velocity[k]) / in.h);
      }
      if (norm2(b.impulse) + norm2(b.twist) == 0) continue;
      sum.add(-b.impulse, 0);
      bodies.push_and_turn(i, b.impulse, b.twist);
      // As by a force that lasts: a floating body is moved up by as much as its weight moves it down.
      bodies.move(i, b.gained.velocity * (0.5 * in.h), b.gained.spin * (0.5 * in.h));
    }
    book(s.own, sum);
  }
  void end(const CoupledStates&, const StepInput&) const override {}

  void observe(const ConstCoupledStates& s, Observables& out) const override { observe_impulses(s.own, out); }
  std::vector<PlanRow> plan() const override {
    return {{PlanRow::Status::runs, "bodies in the medium", medium_ + " moves them with itself"}};
  }

 private:
  static constexpr uint64_t kNobody = UINT64_MAX;
  struct Scratch {
    std::vector<size_t> rows;
    std::vector<Vec3> velocity;
  };
  ImmersionDef def_;
  BodyPort port_;
  size_t count_;
  std::string medium_;
};

[[noreturn]] void refuse(const std::string& member, const std::string& id, const std::string& why,
                         const std::string& allowed) {
  throw Error("scene_invalid", '"' + id + "\" " + why,
              {{"/" + member, "unsuitable_system", '"' + id + "\" " + why, '"' + id + '"', allowed, "", ""}});
}

}  // namespace

std::unique_ptr<const Coupling> build_immersion(const void* def, const CouplingContext& context) {
  const Ports a = context.a.system.ports(), b = context.b.system.ports();
  if (!a.bodies) refuse("a", context.a.id, "has no rigid bodies in space", "a system of type rigid3d");
  if (b.medium == 0) refuse("b", context.b.id, "is no medium that takes bodies", "a system of type sph");
  if (b.medium != 3) refuse("b", context.b.id, "is a medium in the plane", "dimension 3");
  const size_t count = ConstBodies(context.a.state, *a.bodies).count();
  return std::make_unique<const Immersion>(*static_cast<const ImmersionDef*>(def), *a.bodies, count,
                                           context.b.id);
}

}  // namespace truestep::immersion
