#include "engine/systems/rod_chain/rod_chain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/core/commands/command_checks.h"
#include "engine/core/commands/user_forces.h"
#include "engine/core/outputs/outputs_of.h"
#include "engine/core/outputs/tabled.h"
#include "engine/integrators/advance.h"
#include "engine/integrators/table/integrators.h"
#include "engine/systems/rod_chain/treatments.h"

namespace truestep::rod_chain {

using rod_chain::Chain;
using rod_chain::Rod;

namespace {

enum Column : State::Column {
  kPosition,
  kVelocity,
  kDirection,
  kSpin,
  kGravity,
  kPushRod,
  kPushForce,
  kPushRemaining,
  kPushAt,
  kDragRod,
  kDragTarget,
  kDragStiffness,
  kDragAt,
  kCarry
};
// Points of action are kept as their distance along the rod from its centre, in x.
constexpr UserForces kHands{{kPushRod, kPushForce, kPushRemaining, kPushAt},
                            {kDragRod, kDragTarget, kDragStiffness, kDragAt}};
constexpr double kDragDampingRatio = 0.7;  // of a drag on the mass of a rod
constexpr std::string_view kScratch = "rod_chain";
constexpr int kMostHalvings = 12;  // of a step of projection

class RodChain final : public Tabled<RodChain, StagedSystem> {
 public:
  RodChain(const RodChainDef& def, const BuildContext& context) : def_(def), gravity_(context.gravity) {
    chain_.half = 0.5 * def.length, chain_.mass = def.mass, chain_.anchor = def.anchor;
    chain_.inertia = def.mass * def.length * def.length / 12;
    substeps_ = def.substeps.value_or(1);
    if (!def.substeps && def.constraints == RodChainDef::Treatment::penalty) {
      constexpr double kOfTheLimit = 1.0 / 8;
      const double parts = std::ceil(context.dt / (kOfTheLimit * stable_substep()));
      substeps_ = static_cast<int64_t>(std::clamp(parts, 1.0, 1e6));
    }
    const std::string times = std::to_string(substeps_) + (substeps_ == 1 ? " step" : " steps");
    const std::string how[] = {std::string("exact joint forces, ") +
                                   (adaptive() ? "dop853 with its own steps" : "RK4 in " + times) +
                                   ", then positions and velocities are projected",
                               "free flight, then the nearest positions without gaps, in " + times,
                               "springs at the joints, in " + times + " of leapfrog"};
    const char* names[] = {"lagrange", "projection", "penalty"};
    const auto chosen = static_cast<size_t>(def.constraints);
    add_stage(names[chosen], how[chosen], [this](State& s, const StepInput& in) { advance(s, in); });
    for (size_t k = 0; k < 3; ++k) {
      if (k != chosen) skip_stage(names[k], "constraints is " + std::string(names[chosen]));
    }
    add_stage("hands", "ends pushes whose duration is over",
              [](State& s, const StepInput& in) { kHands.count_down(s, in.h); });
    show();
  }

  static const OutputTable& outputs();

  State initial_state() const override {
    const auto n = static_cast<size_t>(def_.links);
    State s;
    s.add({"position", "m", Scalar::f64, 3, Role::position}, n);
    s.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, n);
    s.add({"direction", "1", Scalar::f64, 3, Role::position}, n);
    s.add({"angular_velocity", "rad/s", Scalar::f64, 3, Role::velocity}, n);
    s.add({"gravity", "m/s^2", Scalar::f64, 3}, 1);
    s.add({"push.rod", "1", Scalar::u32}, 0);
    s.add({"push.force", "N", Scalar::f64, 3}, 0);
    s.add({"push.remaining", "s"}, 0);
    s.add({"push.at", "m", Scalar::f64, 3}, 0);
    s.add({"drag.rod", "1", Scalar::u32}, 0);
    s.add({"drag.target", "m", Scalar::f64, 3}, 0);
    s.add({"drag.stiffness", "N/m"}, 0);
    s.add({"drag.at", "m", Scalar::f64, 3}, 0);
    if (adaptive()) s.add({"integrator.carry", "1"}, 2);
    store3(s.f64(kGravity).data(), 0, gravity_);
    const Vec3 u = normalized(def_.direction);
    for (size_t j = 0; j < n; ++j) {
      store3(s.f64(kPosition).data(), j, def_.anchor + u * (def_.length * (static_cast<double>(j) + 0.5)));
      store3(s.f64(kDirection).data(), j, u);
    }
    return s;
  }

  std::optional<Energy> energy(const State& s, double, Workspace& workspace,
                               const ThreadArena&) const override {
    auto& scratch = workspace.object<rod_chain::Scratch>(kScratch);
    load(s, scratch.rods);
    Energy e = energy_of(chain(s), scratch.rods);
    if (kHands.any(s)) e.exchange = Energy::Exchange::open;
    return e;
  }

  void check(StateCheck& check, double) const override {
    const auto n = static_cast<uint64_t>(def_.links);
    kHands.check_pushes(check, n);
    check.together({kDragRod, kDragTarget, kDragStiffness, kDragAt});
    for (const uint32_t rod : check.state().span<uint32_t>(kDragRod))
      check.require(rod < n, "the rod of a drag");
  }

  void apply(State& s, const Command& c) const override {
    check_command_numbers(c);
    const auto rod = [&] { return checked_command_row(c, s.rows(kPosition), "rod"); };
    switch (c.kind) {
      case CommandKind::push: {
        const size_t j = rod();
        return kHands.add_push(s, {j, c.vector, {place(s, c, j), 0, 0}}, c.duration);
      }
      case CommandKind::impulse:
        return hit(s, rod(), c);
      case CommandKind::drag: {
        if (c.value < 0) refuse_command("value", "out_of_range", "the stiffness must be at least 0");
        // The weight of the whole chain stretches a drag of the usual stiffness by a tenth of a metre.
        const double usual = 100 * def_.mass * static_cast<double>(def_.links);
        const size_t j = rod();
        const auto at = c.at ? std::optional(Vec3{place(s, c, j), 0, 0}) : std::nullopt;
        return kHands.set_drag(s, j, c.vector, c.value > 0 ? c.value : usual, at);
      }
      case CommandKind::release:
        return kHands.release(s, c.index == -1 ? std::nullopt : std::optional<uint64_t>(rod()));
      case CommandKind::set_parameter:
        if (c.name != "gravity")
          refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                         "gravity");
        return store3(s.f64(kGravity).data(), 0, c.vector);
      default:
        break;
    }
    refuse_command("type", "unsupported_command", "rods can neither be pinned nor added nor removed",
                   "push, impulse, drag, release, set_parameter");
  }

  void draw(const State& s, double, Wish wishes, Drawing& out) const override {
    if (!wants(wishes, Wish::constant)) return;
    out.parts.resize(2);
    Visual& rod = out.parts[0].visuals.emplace_back();
    rod.shape.kind = DrawnShape::Kind::capsule, rod.shape.size = {def_.radius, chain_.half, 0};
    for (uint32_t j = 0; j < s.rows(kPosition); ++j) out.parts[0].instances.push_back({j, 0});
  }

  std::optional<double> limit(Limit which, const State&, double) const override {
    if (which != Limit::stable_dt || def_.constraints != RodChainDef::Treatment::penalty) return std::nullopt;
    return static_cast<double>(substeps_) * stable_substep();
  }

 private:
  // The nearest point of a rod to that of the command, m from its centre.
  double place(const State& s, const Command& c, size_t j) const {
    if (!c.at) return 0;
    const Vec3 arm = *c.at - load3(s.f64(kPosition).data(), j);
    return std::clamp(dot(arm, load3(s.f64(kDirection).data(), j)), -chain_.half, chain_.half);
  }
  // Springs pass an impulse on in time; where joints are exact, all rods respond at once.
  void hit(State& s, size_t j, const Command& c) const {
    std::vector<Rod> rods = load(s);
    const Change d = pulled(chain_, rods[j], place(s, c, j), c.vector);
    rods[j].v += d.v, rods[j].w += d.w;
    rod_chain::Scratch scratch;
    if (def_.constraints != RodChainDef::Treatment::penalty) close_rates(chain_, rods, scratch);
    store(s, rods);
  }
  struct Whole {
    double kinetic, potential, total, gap;
  };
  Whole whole(const State& s, double) const {
    const auto all = load(s);
    const Chain c = chain(s);
    const Energy e = energy_of(c, all);
    return {e.kinetic, e.potential, e.kinetic + e.potential, rod_chain::largest_gap(c, all)};
  }
  // That turn the y axis, a capsule's own, along the rods.
  static void orientations(const State& s, ShownRows rows, double* out) {
    for (size_t j = 0; j < rows.count; ++j) {
      const Quat q = rotation_between({0, 1, 0}, load3(s.f64(kDirection).data(), j));
      std::copy_n(std::array{q.w, q.x, q.y, q.z}.data(), 4, out + 4 * j);
    }
  }
  // Of every rod, the end that is farther from the anchor.
  void ends(const State& s, ShownRows rows, double* out) const {
    const double *x = s.f64(kPosition).data(), *u = s.f64(kDirection).data();
    for (size_t j = 0; j < rows.count; ++j) store3(out, j, load3(x, j) + load3(u, j) * chain_.half);
  }
  void end_velocities(const State& s, ShownRows rows, double* out) const {
    const double *v = s.f64(kVelocity).data(), *u = s.f64(kDirection).data(), *w = s.f64(kSpin).data();
    for (size_t j = 0; j < rows.count; ++j)
      store3(out, j, load3(v, j) + cross(load3(w, j), load3(u, j)) * chain_.half);
  }
  bool adaptive() const { return def_.constraints == RodChainDef::Treatment::lagrange && !def_.substeps; }
  Energy energy_of(const Chain& c, std::span<const Rod> all) const {
    const bool springs = def_.constraints == RodChainDef::Treatment::penalty;
    Energy e{.kinetic = rod_chain::kinetic(c, all), .potential = rod_chain::potential(c, all)};
    e.exchange = Energy::Exchange::closed;
    e.swing = 2;
    if (springs) e.potential += rod_chain::stored(c, all, def_.stiffness), e.swing = Energy::kSwingNearLimit;
    return e;
  }
  double stable_substep() const {
    // Leapfrog on x'' = -w2 x - d x': h^2 w2 + 2 h d < 4 suffices.
    const double most = rod_chain::largest_eigenvalue(chain_), w2 = def_.stiffness * most,
                 d = def_.damping * most;
    return 4 / (d + std::sqrt(d * d + 4 * w2));
  }
  Chain chain(const State& s) const {
    Chain c = chain_;
    c.gravity = load3(s.f64(kGravity).data(), 0);
    return c;
  }
  static void load(const State& s, std::vector<Rod>& out) {
    out.resize(s.rows(kPosition));
    const double *x = s.f64(kPosition).data(), *v = s.f64(kVelocity).data();
    const double *u = s.f64(kDirection).data(), *w = s.f64(kSpin).data();
    for (size_t j = 0; j < out.size(); ++j) out[j] = {load3(x, j), load3(u, j), load3(v, j), load3(w, j)};
  }
  static std::vector<Rod> load(const State& s) {
    std::vector<Rod> out;
    load(s, out);
    return out;
  }

  static void store(State& s, std::span<const Rod> rods) {
    for (size_t j = 0; j < rods.size(); ++j) {
      const Rod& r = rods[j];
      store3(s.f64(kPosition).data(), j, r.x), store3(s.f64(kVelocity).data(), j, r.v);
      store3(s.f64(kDirection).data(), j, r.u), store3(s.f64(kSpin).data(), j, r.w);
    }
  }
  void load_hands(const State& s, std::vector<Hand>& out) const {
    out.clear();
    for (size_t k = 0; k < kHands.pushes(s); ++k) {
      const UserForces::Push p = kHands.push(s, k);
      out.push_back({.rod = static_cast<size_t>(p.who), .along = p.at.x, .force = p.force});
    }
    for (size_t k = 0; k < kHands.drags(s); ++k) {
      const UserForces::Drag d = kHands.drag(s, k);
      const double damping = 2 * kDragDampingRatio * std::sqrt(d.stiffness * def_.mass);
      out.push_back({.rod = static_cast<size_t>(d.who),
                     .along = d.at.x,
                     .force = {},
                     .stiffness = d.stiffness,
                     .damping = damping,
                     .target = d.target});
    }
  }

  void advance(State& s, const StepInput& in) const {
    auto& scratch = in.workspace.object<rod_chain::Scratch>(kScratch);
    load(s, scratch.rods);
    Chain c = chain(s);
    load_hands(s, scratch.hands);
    c.hands = scratch.hands;
    const double h = in.h / static_cast<double>(substeps_);
    if (adaptive()) choose_steps(s, c, in, scratch);
    for (int64_t k = 0; k < substeps_ && !adaptive(); ++k) {
      switch (def_.constraints) {
        case RodChainDef::Treatment::lagrange:
          rod_chain::step_lagrange(c, scratch.rods, h, def_.tolerance * def_.length, scratch);
          break;
        case RodChainDef::Treatment::projection:
          project(c, h, kMostHalvings, scratch);
          break;
        case RodChainDef::Treatment::penalty:
          rod_chain::step_penalty(c, scratch.rods, h, def_.stiffness, def_.damping, scratch);
          break;
      }
    }
    store(s, scratch.rods);
  }

  // A step from which projection finds no way back to a closed chain is split in two.
  void project(const Chain& c, double h, int halvings, rod_chain::Scratch& scratch) const {
    if (rod_chain::step_projection(c, scratch.rods, h, def_.tolerance * def_.length, scratch)) return;
    if (halvings == 0) throw Instability("", "joints.gap", 0, "no positions without gaps were found");
    for (int half = 0; half < 2; ++half) project(c, 0.5 * h, halvings - 1, scratch);
  }
  void choose_steps(State& s, const Chain& c, const StepInput& in, rod_chain::Scratch& scratch) const {
    static const Integrator& method = *find_integrator("dop853");
    const rod_chain::RodEquations equations(c, scratch, scratch.rods.size());
    const auto y = in.workspace.doubles("rod_chain.y", equations.size());
    rod_chain::RodEquations::write(scratch.rods, y.data());
    const auto carried = s.f64(kCarry);
    Carry carry{carried[0], carried[1]};
    Advance run{
        .f = equations, .t = 0, .t_end = in.h, .y = y.data(), .workspace = in.workspace, .carry = carry};
    run.tolerance.relative = run.tolerance.absolute = def_.error_tolerance;
    run.max_steps = kMaxInternalSteps;
    try {
      method.advance(run);
    } catch (Instability& e) {
      constexpr const char* kParts[] = {"position", "direction", "velocity", "angular_velocity"};
      e.quantity = kParts[static_cast<size_t>(e.index) / 3 % 4];
      e.index /= static_cast<long long>(rod_chain::RodEquations::kNumbers);
      throw;
    }
    carried[0] = carry.step, carried[1] = carry.last_error;
    rod_chain::RodEquations::read(y.data(), scratch.rods);
    rod_chain::close_gaps(c, scratch.rods, def_.tolerance * def_.length, scratch);
  }

  RodChainDef def_;
  Chain chain_;
  int64_t substeps_ = 1;
  Vec3 gravity_;
};

const OutputTable& RodChain::outputs() {
  using R = RodChain;
  static const OutputTable kTable =
      OutputsOf<R>("a rod, starting at the anchor")
          .part("", [](const R& r) { return points_part(static_cast<size_t>(r.def_.links)); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(kPosition), "centre")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(kVelocity), "of the centre")
          .field({"direction", "1", Scalar::f64, 3}, column(kDirection), "unit vector along the rod")
          .field({"angular_velocity", "rad/s", Scalar::f64, 3}, column(kSpin), "")
          .field({"orientation", "1", Scalar::f64, 4, Meaning::orientation}, computed(&R::orientations),
                 "quaternion (w, x, y, z) that turns the y axis along the rod")
          .part("ends", [](const R& r) { return values_part(static_cast<size_t>(r.def_.links)); })
          .field({"end", "m", Scalar::f64, 3}, computed_by<R>(&R::ends),
                 "part ends: of the rod, away from the anchor")
          .field({"end_velocity", "m/s", Scalar::f64, 3}, computed_by<R>(&R::end_velocities), "part ends")
          .measured(&R::whole, {{"energy.kinetic", "J", &Whole::kinetic, "of motion"},
                                {"energy.potential", "J", &Whole::potential, "of all conservative forces"},
                                {"energy.total", "J", &Whole::total, "their sum"},
                                {"joints.gap", "m", &Whole::gap, "largest gap between the ends at a joint"}})
          .build();
  return kTable;
}

}  // namespace

const Outputs& rod_chain_outputs() {
  static const Outputs kDescribed = RodChain::outputs().described();
  return kDescribed;
}

const DefTable& rod_chain_table() {
  using D = RodChainDef;
  static const DefTable t =
      TableOf<D>("thin rigid rods joined end to end, with one of three treatments of the joints")
          .choice("constraints", &D::constraints, {"lagrange", "projection", "penalty"},
                  "treatment of joints: exact forces from the KKT system; positions projected after free "
                  "flight; stiff springs")
          .integer("links", &D::links, between(1, 100'000), "number of rods")
          .number("length", &D::length, "m", above(0), "of each rod")
          .number("mass", &D::mass, "kg", above(0), "of each rod")
          .number("radius", &D::radius, "m", above(0), "of the drawing")
          .vector("anchor", &D::anchor, "m", any(), "point where the first rod hangs")
          .vector("direction", &D::direction, "1", any(),
                  "of all rods at t = 0, when they are at rest; any length")
          .number("stiffness", &D::stiffness, "N/m", above(0), "penalty: of the joints' springs")
          .number("damping", &D::damping, "N s/m", at_least(0), "penalty: of the joints' springs")
          .number("tolerance", &D::tolerance, "1", between(1e-15, 0.1),
                  "projection and lagrange: largest gap left, over the length of a rod")
          .number("error_tolerance", &D::error_tolerance, "1", between(1e-14, 0.1),
                  "lagrange without substeps: bound on the local error of every internal step")
          .integer("substeps", &D::substeps, between(1, 100'000),
                   "steps of the method per step of the scene; absent: as many as the treatment needs")
          .check([](const D& d, const DefTable::Report& report) {
            if (!(norm(d.direction) > 0)) report("/direction", "the direction must not be zero");
          })
          .build();
  return t;
}

std::unique_ptr<const System> build_rod_chain(const void* def, const BuildContext& context) {
  return std::make_unique<const RodChain>(*static_cast<const RodChainDef*>(def), context);
}

Cost rod_chain_cost(const void* def) {
  const auto& d = *static_cast<const RodChainDef*>(def);
  const auto n = static_cast<double>(d.links),
             steps = static_cast<double>(
                 d.substeps.value_or(d.constraints == RodChainDef::Treatment::projection ? 1 : 8));
  const double each = d.constraints == RodChainDef::Treatment::penalty      ? 1.5e-8
                      : d.constraints == RodChainDef::Treatment::projection ? 1.2e-7
                                                                            : 3e-7;
  return {
      .state_bytes = 96 * n, .workspace_bytes = 800 * n, .elements = n, .seconds_per_step = n * steps * each};
}

}  // namespace truestep::rod_chain
