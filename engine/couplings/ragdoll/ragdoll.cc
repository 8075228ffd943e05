#include "engine/couplings/ragdoll/ragdoll.h"

#include <algorithm>
#include <string>

#include "engine/base/errors.h"
#include "engine/core/ports/body_carrier.h"
#include "engine/core/ports/rig_port.h"

namespace truestep::ragdoll {

using animation::conjugate;
using animation::rotate;

const DefTable& ragdoll_table() {
  using D = RagdollDef;
  constexpr Count kBones{0, 10'000};
  static const DefTable t =
      TableOf<D>("bodies of b that follow bones of a until they are released and then lead a")
          .integers("bones", &D::bones, at_least(0), kBones,
                    "indices of bones; absent: as many as bodies, from 0")
          .integers("bodies", &D::bodies, at_least(0), kBones,
                    "indices of their bodies; absent: as many as bones, from 0")
          .number("at", &D::at, "s", at_least(0), "time when the bodies are released")
          .number("impact", &D::impact, "m/s", above(0),
                  "change of a body's velocity in a substep above which all are released")
          .integers("impact_bodies", &D::impact_bodies, at_least(0), kBones,
                    "bodies whose impacts count; absent: all")
          .number("back_after", &D::back_after, "s", at_least(0),
                  "how long the bodies lead; absent: for ever")
          .number("blend", &D::blend, "s", at_least(0), "time of the blend back to the skeleton's own motion")
          .number("match_from", &D::match_from, "s", at_least(0),
                  "first time of the skeleton's motion at which it may continue")
          .number("match_to", &D::match_to, "s", at_least(0),
                  "last such time; absent: the motion continues as if nothing had happened")
          .check([](const D& d, const DefTable::Report& report) {
            if (!d.bones.empty() && !d.bodies.empty() && d.bones.size() != d.bodies.size())
              report("/bodies", "needs as many bodies as bones");
            if (d.match_to && *d.match_to < d.match_from.value_or(0))
              report("/match_to", "the last time is before the first");
            for (const auto* list : {&d.bones, &d.bodies}) {
              std::vector<int64_t> sorted = *list;
              std::ranges::sort(sorted);
              if (std::ranges::adjacent_find(sorted) != sorted.end())
                report(list == &d.bones ? "/bones" : "/bodies", "each index must occur once");
            }
          })
          .build();
  return t;
}

Cost ragdoll_cost(const void*, const Cost& a, const Cost& b) {
  const double bones = std::min(a.elements, b.elements);
  // The elements of a include its skin's vertices, which follow the bodies once those lead.
  return {.state_bytes = 160 * bones + 400,
          .workspace_bytes = 2048 + 600 * bones + 30 * a.elements,
          .elements = bones,
          .seconds_per_step = 1e-6 + 2e-7 * bones};
}

namespace {

enum : State::Column { kMode, kTime, kImpact, kApart };
/// Which side leads.
enum class Lead : uint32_t { skeleton, bodies, skeleton_again };

struct Pair {
  size_t bone = 0, body = 0;
  Pose offset;  ///< of the body in the bone's frame
  bool feels = true;
};

class Ragdoll final : public Coupling {
 public:
  Ragdoll(const RagdollDef& def, const RigPort& rig, const BodyPort& bodies, std::vector<Pair> pairs,
          size_t bones)
      : def_(def), rig_(rig), bodies_(bodies), pairs_(std::move(pairs)), given_(bones, 0) {
    for (const Pair& p : pairs_) given_[p.bone] = 1;
    match_ = {.blend = def.blend, .from = def.match_from.value_or(0), .to = def.match_to.value_or(0)};
    if (!def.match_to) match_.to = match_.from;
  }

  State initial_state() const override {
    State s;
    s.add({"lead", "1", Scalar::u32}, 1);
    s.add({"time", "s"}, 1);
    s.add({"impact", "m/s"}, 1);
    s.add({"apart", "m"}, 1);
    return s;
  }

  void begin(const CoupledStates& s, const StepInput& in) const override {
    rig_.follower->prepare(s.a);
    if (lead(s.own) == Lead::bodies) return;
    carry(s, in);
    if (lead(s.own) != Lead::skeleton || !def_.at || in.t < *def_.at - 1e-9 * in.h) return;
    hand_over(s.own, in.t);
    follow(s, in, 0);  // the present pose
  }
  void end(const CoupledStates& s, const StepInput& in) const override {
    const double after = in.t + in.h;
    if (lead(s.own) != Lead::bodies) {
      look_for_impact(s);
      if (def_.impact && s.own.f64(kImpact)[0] > *def_.impact) {
        hand_over(s.own, after);
        // The skeleton still moved by itself in this step.
        follow(s, in, 0);
      } else {
        carry(s, in);
      }
      return;
    }
    follow(s, in, in.h);
    if (def_.back_after && after >= s.own.f64(kTime)[0] + *def_.back_after - 1e-9 * in.h) {
      rig_.follower->resume(s.a, after, match_, in.workspace);
      s.own.span<uint32_t>(kMode)[0] = static_cast<uint32_t>(Lead::skeleton_again);
    }
  }

  void observe(const ConstCoupledStates& s, Observables& out) const override {
    out.add("lead", static_cast<double>(s.own.span<uint32_t>(kMode)[0]), "1");
    out.add("time", s.own.f64(kTime)[0], "s");
    out.add("impact", s.own.f64(kImpact)[0], "m/s");
    out.add("apart", s.own.f64(kApart)[0], "m");
  }
  std::vector<PlanRow> plan() const override {
    std::string when = def_.at ? "at " + std::to_string(*def_.at) + " s" : "";
    if (def_.impact)
      when += (when.empty() ? "" : " or ") + ("by an impact of " + std::to_string(*def_.impact) + " m/s");
    std::vector<PlanRow> rows{{PlanRow::Status::runs, "carry",
                               std::to_string(pairs_.size()) + " bodies on bones" +
                                   (when.empty() ? ", for ever" : ", released " + when)}};
    const bool back = def_.back_after.has_value();
    rows.push_back({back ? PlanRow::Status::runs : PlanRow::Status::skipped, "back",
                    back ? "the skeleton leads again after " + std::to_string(*def_.back_after) + " s"
                         : "back_after is not given"});
    return rows;
  }

 private:
  static Lead lead(const State& own) { return static_cast<Lead>(own.span<uint32_t>(kMode)[0]); }
  static void hand_over(State& own, double t) {
    own.span<uint32_t>(kMode)[0] = static_cast<uint32_t>(Lead::bodies);
    own.f64(kTime)[0] = t;
  }
  /// Pose and velocities of a bone's body as carried by the bone.
  static BodyMotion carried(const ConstBodies& bones, const Pair& p) {
    const Pose bone{bones.place(p.bone), bones.orientation(p.bone)};
    const Vec3 arm = rotate(bone.orientation, p.offset.position);
    return {bone.position + arm, normalized(bone.orientation * p.offset.orientation),
            bones.velocity_at(p.bone, arm), bones.spin(p.bone)};
  }
  void carry(const CoupledStates& s, const StepInput& in) const {
    const ConstBodies bones(s.a, rig_.bones);
    const ConstBodies bodies(s.b, bodies_);
    auto& wanted = in.workspace.object<CarriedBodies>("ragdoll.wanted");
    wanted.start(bodies.count());
    for (const Pair& p : pairs_) {
      if (const auto row = bodies.row_of(p.body)) wanted.want(*row, carried(bones, p));
    }
    truestep::carry(s.b, bodies_, wanted, in.workspace);
    if (bodies.free()) return;
    // Their joints may hold the bodies back.
    double most = 0;
    for (size_t row = 0; row < wanted.given.size(); ++row) {
      if (wanted.given[row]) most = std::max(most, norm(bodies.place(row) - wanted.motions[row].place));
    }
    s.own.f64(kApart)[0] = most;
  }
  /// Bones are already at their new poses; any further motion of the bodies in this step comes from an
  /// impact.
  void look_for_impact(const CoupledStates& s) const {
    const ConstBodies bones(s.a, rig_.bones), bodies(s.b, bodies_);
    double most = 0;
    for (const Pair& p : pairs_) {
      const auto row = bodies.row_of(p.body);
      if (p.feels && row) most = std::max(most, norm(bodies.velocity(*row) - carried(bones, p).velocity));
    }
    s.own.f64(kImpact)[0] = most;
  }
  void follow(const CoupledStates& s, const StepInput& in, double h) const {
    auto& poses = in.workspace.object<std::vector<Pose>>("ragdoll.poses");
    auto& given = in.workspace.object<std::vector<uint8_t>>("ragdoll.given");
    poses.resize(given_.size()), given = given_;
    const ConstBodies bodies(s.b, bodies_);
    for (const Pair& p : pairs_) {
      const auto row = bodies.row_of(p.body);
      given[p.bone] = row ? 1 : 0;
      if (!row) continue;
      const Quat q = normalized(bodies.orientation(*row) * conjugate(p.offset.orientation));
      poses[p.bone] = {bodies.place(*row) - rotate(q, p.offset.position), q};
    }
    rig_.follower->follow(s.a, poses, given, h, in.workspace);
    const ConstBodies bones(s.a, rig_.bones);
    double most = 0;
    for (const Pair& p : pairs_) {
      if (given[p.bone]) most = std::max(most, norm(bones.place(p.bone) - poses[p.bone].position));
    }
    s.own.f64(kApart)[0] = most;
  }

  RagdollDef def_;
  RigPort rig_;
  BodyPort bodies_;
  std::vector<Pair> pairs_;
  std::vector<uint8_t> given_;
  PoseMatch match_;
};

[[noreturn]] void refuse(const std::string& member, const std::string& why, const std::string& value,
                         const std::string& allowed) {
  throw Error("scene_invalid", why, {"/" + member, "unsuitable_system", why, value, allowed, "", ""});
}

}  // namespace

std::unique_ptr<const Coupling> build_ragdoll(const void* def, const CouplingContext& context) {
  const auto& d = *static_cast<const RagdollDef*>(def);
  const auto rig = rig_of(context.a.system);
  const Ports b = context.b.system.ports();
  if (!rig || !rig->follower) {
    refuse("a", '"' + context.a.id + "\" has no bones", '"' + context.a.id + '"', "a skeleton");
  }
  if (!b.bodies || rig_of(context.b.system)) {
    refuse("b", '"' + context.b.id + "\" has no dynamic bodies", '"' + context.b.id + '"',
           "a rigid3d or an articulation");
  }
  if (!can_be_carried(*b.bodies)) {
    refuse("b", "bodies of \"" + context.b.id + "\" cannot follow bones", '"' + context.b.id + '"',
           "a rigid3d or an articulation");
  }
  const ConstBodies bones(context.a.state, rig->bones), bodies(context.b.state, *b.bodies);
  const size_t n = !d.bones.empty()    ? d.bones.size()
                   : !d.bodies.empty() ? d.bodies.size()
                                       : std::min(bones.count(), bodies.count());
  std::vector<Pair> pairs;
  for (size_t k = 0; k < n; ++k) {
    const auto number = [&](const std::vector<int64_t>& list, const char* member, size_t count) {
      const size_t i = list.empty() ? k : static_cast<size_t>(list[k]);
      if (i < count) return i;
      refuse(std::string(member) + "/" + std::to_string(k), "there is no such row of " + std::string(member),
             std::to_string(i), count == 0 ? "there are none" : "0 to " + std::to_string(count - 1));
    };
    Pair p{number(d.bones, "bones", bones.count()), number(d.bodies, "bodies", bodies.count()), {}, true};
    if (!bodies.dynamic(p.body)) {
      refuse("bodies/" + std::to_string(k), "this body is not dynamic", std::to_string(p.body),
             "dynamic bodies");
    }
    const Quat back = conjugate(bones.orientation(p.bone));
    p.offset = {rotate(back, bodies.place(p.body) - bones.place(p.bone)),
                normalized(back * bodies.orientation(p.body))};
    if (!d.impact_bodies.empty())
      p.feels = std::ranges::find(d.impact_bodies, static_cast<int64_t>(p.body)) != d.impact_bodies.end();
    // Ids stay valid when other bodies are removed.
    p.body = bodies.id_of(p.body);
    pairs.push_back(p);
  }
  return std::make_unique<Ragdoll>(d, *rig, *b.bodies, std::move(pairs), bones.count());
}

}  // namespace truestep::ragdoll
