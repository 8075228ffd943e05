#include "engine/systems/skeleton/scratch.h"

namespace truestep::skeleton {

using namespace animation;
using C = SkeletonColumns;

namespace {

constexpr MovedBodies kBones = MovedBodies::from(0);

}  // namespace

Skeleton::Skeleton(const SkeletonDef& given, const BuildContext& context)
    : driver_(given, context.id), dt_(context.dt), publish_(given.publish), color_(given.color) {
  const SkeletonDef def = with_file(given, file_);
  model_ = build_model(def, driver_);
  take_motions(def);
  if (def.skin && !model_.joints.empty()) {
    build_skin(*def.skin, model_, driver_);
    skinning_ = def.skin->method, skin_color_ = def.skin->color;
  }
  driver_.finish();
  options_ = {.method = def.solver,
              .tolerance = def.tolerance,
              .most = def.max_iterations,
              .elbow = def.elbow == SkeletonDef::Elbow::positive ? 1.0 : -1.0};
  for (const Bone& b : model_.bones) {
    solids_.push_back(capsule_solid(b.radius, 0.5 * norm(b.end)));
    bone_poses_.push_back({b.end * 0.5, rotation_between({0, 1, 0}, normalized(b.end))});
    joint_of_bone_.push_back(b.joint);
  }
  for (const Solid& s : solids_) forms_.push_back({&s, 0, {}});
  plan_stages(def);
  show();
  set_remedies({"expressions that stay finite at every time"});
}

void Skeleton::take_motions(const SkeletonDef& def) {
  if (model_.joints.empty()) return;
  if (def.motion && def.motion->markers) {
    MotionDef motion = *def.motion;
    markers_.emplace();
    // The scale applies to the markers, not to the motion fitted to them.
    file_ = recording_of(*motion.markers, motion.scale, model_, "/motion/markers", *markers_);
    motion.scale = 1, motion.root_scale = 1;
    clip_ = Clip(motion, *file_, model_, driver_, "/motion");
  } else if (def.motion) {
    clip_ = Clip(*def.motion, *file_, model_, driver_, "/motion");
  }
  for (size_t k = 0; k < def.layers.size(); ++k) {
    const std::string at = "/layers/" + std::to_string(k);
    const LayerDef& d = def.layers[k];
    const Recording file = *read_recording(d.motion, at + "/motion");
    layers_.push_back({Clip(d.motion, file, model_, driver_, at + "/motion"),
                       driver_.add(at + "/weight", d.weight), d.mode});
  }
  if (def.prior) learn(*def.prior);
}

void Skeleton::learn(const PriorDef& def) {
  const Recording file = *read_recording(def.motion, "/prior/motion");
  const Clip clip(def.motion, file, model_, driver_, "/prior/motion");
  const size_t n = model_.joints.size();
  std::vector<uint8_t> known(n, 0);
  clip.mark(known);
  std::vector<JointMotion> poses(n * clip.frames());
  for (size_t f = 0; f < clip.frames(); ++f) clip.frame(f, std::span(poses).subspan(f * n, n));
  if (clip.frames() < 2) {
    driver_.fault({"/prior/motion", "too_short", "a prior needs at least two frames", "", "", "", ""});
    return;
  }
  prior_ = PosePrior(model_.joints, poses, known, static_cast<size_t>(def.components), def.variation);
  prior_spread_ = def.spread;
}

void Skeleton::plan_stages(const SkeletonDef& def) {
  // While bodies lead the skeleton, they alone move it.
  const auto stage = [this](auto&& run) {
    return [this, run](State& s, const StepInput& in) {
      if (is_led(s)) return;
      auto& scratch = in.workspace.object<Scratch>("skeleton");
      scratch.arena = &in.arena;
      run(s, in, scratch);
    };
  };
  add_stage("drive",
            std::to_string(model_.joints.size()) + " joints" +
                (file_ ? ", recorded motion of " + std::to_string(clip_.frames()) + " frames" : ""),
            stage([this](State& s, const StepInput& in, Scratch& w) { drive(s, in.t + in.h, w); }));
  if (clip_.feet() > 0) {
    add_stage("foot lock", "standing feet are kept in place",
              stage([this](State& s, const StepInput& in, Scratch& w) { hold_feet(s, in.t + in.h, w); }));
  } else {
    skip_stage("foot lock", "no feet are named");
  }
  add_stage("reach",
            model_.goals.empty() ? "only when a joint is dragged"
                                 : std::to_string(model_.goals.size()) + " goals, at most " +
                                       std::to_string(def.max_iterations) + " iterations",
            stage([this](State& s, const StepInput&, Scratch& w) { reach(s, w); }));
  add_stage("bones", "forward kinematics and velocities",
            stage([this](State& s, const StepInput& in, Scratch& w) {
              blend_back(s, in.t + in.h, w);
              write(s, in.h, w);
            }));
  if (!model_.skin.empty()) {
    add_stage("skin",
              std::to_string(model_.skin.size()) + " vertices by " +
                  (skinning_ == SkinDef::Method::linear ? "matrices" : "dual quaternions"),
              stage([this](State& s, const StepInput& in, Scratch& w) { cover(s, in.h, w); }));
  } else {
    skip_stage("skin", "there is no skin");
  }
}

State Skeleton::initial_state() const {
  State s;
  const size_t n = model_.joints.size();
  MovedBodies::add(s, "bone.", model_.bones.size());
  driver_.add_column(s);
  s.add({"position", "m", Scalar::f64, 3, Role::position}, n);
  s.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, n);
  s.add({"orientation", "1", Scalar::f64, 4}, n);
  s.add({"coordinates", "1", Scalar::f64, 8}, n);
  s.add({"drag.joint", "1", Scalar::i32}, 1);
  s.add({"drag.target", "m", Scalar::f64, 3}, 1);
  s.add({"solved", "1", Scalar::f64, 4}, 1);
  s.add({"skin.position", "m", Scalar::f64, 3, Role::position}, model_.skin.size());
  s.add({"skin.velocity", "m/s", Scalar::f64, 3, Role::velocity}, model_.skin.size());
  s.add({"skin.inverse_mass", "1/kg"}, model_.skin.size());
  s.span<int32_t>(C::kDragJoint)[0] = -1;
  for (size_t j = 0; j < n; ++j) {
    // The coordinates closest to rest that the limits allow.
    JointMotion m;
    apply_limits(model_.joints[j], m);
    write_motion(m, &s.f64(C::kCoordinates)[8 * j]);
  }
  Scratch scratch;
  update(s, 0, 0, scratch);
  // Initial velocities are those of the first step.
  State ahead = s;
  update(ahead, dt_, dt_, scratch);
  for (const State::Column c : {kBones.velocity, kBones.angular_velocity, State::Column{C::kJointVelocity},
                                State::Column{C::kSkinVelocity}}) {
    s.copy_column(c, ahead, c);
  }
  return s;
}

Ports Skeleton::ports() const {
  Ports out;
  out.rig = this, out.driver = &driver_;
  if (publish_ == SkeletonDef::Publish::bones) {
    out.bodies = kBones.port(forms_);
    return out;
  }
  out.points = PointPort{.position = C::kSkin,
                         .velocity = C::kSkinVelocity,
                         .mass = std::nullopt,
                         .inverse_mass = C::kSkinInverseMass,
                         .id = std::nullopt,
                         .radius = 0};
  out.solids = {model_.triangles, {}};
  return out;
}

RigPort Skeleton::rig() const {
  return {.names = model_.ids,
          .joints = model_.joints,
          .position = C::kJointPosition,
          .orientation = C::kJointOrientation,
          .bones = kBones.port(forms_),
          .joint_of_bone = joint_of_bone_,
          .bone_in_joint = bone_poses_,
          .skin = model_.skin,
          .weights = model_.weights,
          .triangles = model_.triangles,
          .rest = model_.rest,
          .follower = this};
}

std::unique_ptr<const System> build_skeleton(const void* def, const BuildContext& context) {
  return std::make_unique<Skeleton>(*static_cast<const SkeletonDef*>(def), context);
}

}  // namespace truestep::skeleton
