#include "engine/reference/bullet.h"

#include <mutex>

#include "engine/reference/bullet_joints.h"
#include "engine/reference/bullet_world.h"
#include "engine/reference/own_face.h"
#include "engine/systems/rigid3d/forces.h"
#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep {
namespace {

// The library counts and times itself in global variables: only one world steps at a time.
std::mutex g_bullet;

class Bullet final : public reference::OwnFace<rigid3d::Rigid3d> {
 public:
  Bullet(const rigid3d::Rigid3dDef& def, const BuildContext& context, std::vector<Issue>& issues)
      : OwnFace(def, context),
        scene_(std::make_shared<const reference::BulletScene>(def, context, issues)),
        key_("bullet/" + context.id) {
    add_stage("forces", "gravity and pushes", [this](State& s, const StepInput& in) {
      auto& scratch = in.workspace.object<Scratch>(key_);
      rigid3d::collect_forces(s, own_.kinds(), in.h, scratch.change, scratch.twist);
    });
    add_stage("bullet", "Bullet 3.24 in doubles: ten iterations of sequential impulses",
              [this](State& s, const StepInput& in) { step_world(s, in); });
    skip_stage(
        "exact restore",
        "Bullet keeps the impulses of its contacts to itself: after a snapshot, a seek or a command that "
        "moves a body they start from nothing");
  }

 private:
  struct Scratch {
    std::vector<Vec3> change, twist;
    std::unique_ptr<reference::BulletWorld> world;
  };

  void step_world(State& s, const StepInput& in) const {
    auto& scratch = in.workspace.object<Scratch>(key_);
    const std::lock_guard lock(g_bullet);
    if (!scratch.world || !scratch.world->matches(*scene_, s)) {
      scratch.world = std::make_unique<reference::BulletWorld>(scene_, s);
    }
    scratch.world->step(s, in.h, scratch.change, scratch.twist);
  }

  std::shared_ptr<const reference::BulletScene> scene_;
  std::string key_;
};

}  // namespace

std::unique_ptr<const System> build_bullet(const rigid3d::Rigid3dDef& def, const BuildContext& context) {
  std::vector<Issue> issues;
  reference::check_bullet_scene(def, issues);
  std::unique_ptr<const Bullet> system;
  if (issues.empty()) system = std::make_unique<const Bullet>(def, context, issues);
  if (!issues.empty())
    throw Error("scene_invalid", "the scene has parts that Bullet cannot hold", std::move(issues));
  return system;
}

}  // namespace truestep
