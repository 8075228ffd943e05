// Outputs of a skeleton, and how commands change it.
#include "engine/core/commands/command_checks.h"
#include "engine/systems/skeleton/scratch.h"

namespace truestep::skeleton {

using namespace animation;
using C = SkeletonColumns;

namespace {
constexpr MovedBodies kObservedBones = MovedBodies::from(0);
constexpr size_t kMostNamed = 32;  // joints whose positions are observables
}  // namespace

void Skeleton::observe(const State& s, double at, Observables& out) const {
  const double t = own_time(s, at);
  driver_.observe(t, s.f64(C::kControl), out);
  const auto solved = s.f64(C::kSolved);
  const double* x = s.f64(C::kJointPosition).data();
  if (!model_.goals.empty()) {
    out.add("ik.error", solved[0], "m");
    out.add("ik.iterations", solved[1], "1");
    out.add("ik.reached", solved[2], "1");
    Driver::Scratch scratch;
    const auto outputs = driver_.outputs_at(t, s.f64(C::kControl), scratch);
    for (const GoalDrive& g : model_.goals) {
      const double* q = &s.f64(C::kJointOrientation)[4 * g.goal.joint];
      const Vec3 place = load3(x, g.goal.joint) + rotate({q[0], q[1], q[2], q[3]}, g.goal.point);
      const Vec3 target = goal(g, outputs).target;
      out.add("goal." + g.id + ".error", norm(target - place), "m");
      double length = norm(g.goal.point);
      for (uint32_t j = g.goal.joint; j != g.goal.base; j = static_cast<uint32_t>(model_.joints[j].parent))
        length += norm(model_.joints[j].rest.position);
      if (length > 0)
        out.add("goal." + g.id + ".stretch", norm(target - load3(x, g.goal.base)) / length, "1");
    }
  }
  if (!prior_.empty()) {
    std::vector<JointMotion> motion(model_.joints.size());
    std::vector<double> scratch;
    for (size_t j = 0; j < motion.size(); ++j) motion[j] = read_motion(&s.f64(C::kCoordinates)[8 * j]);
    out.add("prior.distance", prior_.distance(motion, scratch), "1");
    out.add("prior.explained", prior_.explained(), "1");
  }
  if (markers_) {
    out.add("markers.error", markers_->error, "m");
    out.add("markers.seen", markers_->seen, "1");
    out.add("markers.outliers", markers_->outliers, "1");
    if (markers_->residual > 0) out.add("markers.residual", markers_->residual, "1");
  }
  if (clip_.feet() > 0) {
    out.add("foot_lock.slide", clip_.slide(), "m");
    out.add("foot_lock.error", solved[3], "m");
  }
  if (model_.joints.size() > kMostNamed) return;
  for (size_t j = 0; j < model_.joints.size(); ++j) {
    const Vec3 p = load3(x, j);
    out.add("joint." + model_.ids[j] + ".x", p.x, "m");
    out.add("joint." + model_.ids[j] + ".y", p.y, "m");
    out.add("joint." + model_.ids[j] + ".z", p.z, "m");
  }
}

FieldView Skeleton::field(const State& s, size_t part, size_t which, std::vector<double>& scratch) const {
  if (part == 0 && which == 3) {
    scratch.resize(model_.joints.size());
    for (size_t j = 0; j < scratch.size(); ++j) {
      const double* c = &s.f64(C::kCoordinates)[8 * j];
      scratch[j] = model_.joints[j].kind == JointKind::ball
                       ? norm(free_rotation::rotation_vector(Quat{c[1], c[2], c[3], c[4]}))
                       : c[0];
    }
    return {scratch.data(), Scalar::f64, scratch.size(), 1};
  }
  constexpr State::Column kColumns[3][4] = {{C::kJointPosition, C::kJointVelocity, C::kJointOrientation, 0},
                                            {kObservedBones.position, kObservedBones.velocity,
                                             kObservedBones.orientation, kObservedBones.angular_velocity},
                                            {C::kSkin, C::kSkinVelocity, 0, 0}};
  const State::Column c = kColumns[part][which];
  return {s.f64(c).data(), Scalar::f64, s.rows(c), s.info(c).width};
}

void Skeleton::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  int32_t& dragged = s.span<int32_t>(C::kDragJoint)[0];
  switch (c.kind) {
    case CommandKind::set_parameter: {
      if (driver_.apply(s, C::kControl, c)) return;
      std::string all;
      for (size_t k = 0; k < driver_.controls(); ++k) all += (k > 0 ? ", " : "") + driver_.control(k);
      refuse_command("name", "unknown_parameter", "there is no control \"" + c.name + "\"", all);
    }
    case CommandKind::drag:
      refuse_place(c, "joint");
      dragged = static_cast<int32_t>(checked_command_row(c, model_.joints.size(), "joint"));
      store3(s.f64(C::kDragTarget).data(), 0, c.vector);
      return;
    case CommandKind::release:
      dragged = -1;
      return;
    default:
      refuse_command("type", "unsupported_command", "a skeleton moves as prescribed",
                     "set_parameter, drag, release");
  }
}

void Skeleton::check(StateCheck& check, double) const {
  const size_t n = model_.joints.size(), led = 2 * n + LeadRows::rows,
               rows = check.state().rows(C::kCoordinates);
  check.below(kObservedBones.form, model_.bones.size()).below(C::kDragJoint, n);
  check.together({C::kCoordinates}, led)
      .require(rows == n || rows == led, "coordinates are those of all joints");
}

void Skeleton::draw(const State&, double, Wish wishes, Drawing& out) const {
  if (!wants(wishes, Wish::constant)) return;
  out.parts.resize(parts().size());
  const auto color = [](const std::optional<Vec3>& c) -> std::optional<std::array<double, 3>> {
    if (!c) return std::nullopt;
    return std::array{c->x, c->y, c->z};
  };
  for (uint32_t j = 0; j < model_.joints.size(); ++j) {
    if (model_.joints[j].parent < 0) continue;
    out.parts[0].lines.push_back({static_cast<uint32_t>(model_.joints[j].parent), j});
    out.parts[0].line_kinds.push_back(LineKind::structural);
  }
  if (model_.skin.empty()) {
    for (uint32_t b = 0; b < model_.bones.size(); ++b) {
      Visual v;
      v.shape.kind = DrawnShape::Kind::capsule, v.shape.size = solids_[b].size;
      v.color = color(color_), v.motion = Visual::Motion::kinematic;
      out.parts[1].instances.push_back({b, b});
      out.parts[1].visuals.push_back(std::move(v));
    }
    return;
  }
  out.parts[2].triangles = model_.triangles;
  out.parts[2].color = color(skin_color_);
}

}  // namespace truestep::skeleton
