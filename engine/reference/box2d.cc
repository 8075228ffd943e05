#include "engine/reference/box2d.h"

#include <mutex>

#include "engine/reference/box2d_joints.h"
#include "engine/reference/box2d_world.h"
#include "engine/reference/own_face.h"
#include "engine/systems/rigid2d/rigid2d.h"

namespace truestep {
namespace {

// The library counts its calls in global variables: only one world steps at a time.
std::mutex g_box2d;

class Box2d final : public reference::OwnFace<rigid2d::Rigid2d> {
 public:
  Box2d(const rigid2d::Rigid2dDef& def, const BuildContext& context)
      : OwnFace(def, context),
        scene_(std::make_shared<const reference::Box2dScene>(def, context)),
        key_("box2d/" + context.id) {
    add_stage("box2d", "Box2D 2.4.1 in floats: 8 iterations for velocities, 3 for positions",
              [this](State& s, const StepInput& in) { step_world(s, in); });
    skip_stage(
        "exact restore",
        "Box2D keeps the impulses of its contacts to itself: after a snapshot, a seek or a command that "
        "moves a body they start from nothing");
  }

 private:
  struct Scratch {
    std::unique_ptr<reference::Box2dWorld> world;
  };

  void step_world(State& s, const StepInput& in) const {
    auto& scratch = in.workspace.object<Scratch>(key_);
    const std::lock_guard lock(g_box2d);
    if (!scratch.world || !scratch.world->matches(*scene_, s)) {
      scratch.world = std::make_unique<reference::Box2dWorld>(scene_, s);
    }
    scratch.world->step(s, in.h);
  }

  std::shared_ptr<const reference::Box2dScene> scene_;
  std::string key_;
};

}  // namespace

std::unique_ptr<const System> build_box2d(const rigid2d::Rigid2dDef& def, const BuildContext& context) {
  std::vector<Issue> issues;
  reference::check_box2d_scene(def, rigid2d::build_model(def), issues);
  if (!issues.empty())
    throw Error("scene_invalid", "the scene has parts that Box2D cannot hold", std::move(issues));
  return std::make_unique<const Box2d>(def, context);
}

}  // namespace truestep
