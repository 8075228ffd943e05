// Rigid bodies: a pyramid of 1240 boxes, one thread, CPU time. What doubles in
// the contact solver cost beside floats, and what the pyramid costs asleep; beside Bullet where it is
// installed. Error: deepest penetration in m at the end.
#include "engine/systems/rigid3d/rigid3d.h"
#include "tests/bench/report.h"
#ifdef TRUESTEP_BULLET
#include <btBulletDynamicsCommon.h>

#include <memory>
#endif

namespace {

using namespace truestep;

constexpr double kStep = 1.0 / 60;
constexpr int kLayers = 15, kSettle = 60, kRounds = 7, kSteps = 20;

Rigid3dDef pyramid() {
  Rigid3dDef d;
  BoxBodyDef ground;
  ground.motion = BodyDef::Motion::fixed, ground.half_extents = {100, 1, 100}, ground.position = {0, -1, 0};
  BoxBodyDef box;
  box.position = {0, 0.5, 0}, box.copies = CopiesDef{};
  box.copies->layout = CopiesDef::Layout::pyramid, box.copies->count = {kLayers};
  box.copies->spacing = {1.05, 1, 1.05};
  d.bodies = {ground, box};
  return d;
}

struct Ours {
  explicit Ours(const Rigid3dDef& def) : system(def, {}), state(system.initial_state()) {}
  void run(int steps) {
    for (int k = 0; k < steps; ++k, ++step) {
      system.step(state, {static_cast<double>(step) * kStep, kStep, step, workspace, arena});
    }
  }
  double observed(const char* name) const {
    Observables out;
    system.observe(state, 0, out);
    return out.find(name).value();
  }
  Rigid3d system;
  State state;
  Workspace workspace;
  ThreadArena arena{1};
  uint64_t step = 0;
};

void compare(const char* metric, const char* peer_name, const bench::Times& t,
             std::optional<double> ours = {}, std::optional<double> peer = {}) {
  bench::report({.bench = "rigid3d",
                 .metric = metric,
                 .ours = t.ours / kSteps,
                 .peer = t.peer / kSteps,
                 .peer_name = peer_name,
                 .error_ours = ours,
                 .error_peer = peer});
}

#ifdef TRUESTEP_BULLET
class Bullet {
 public:
  explicit Bullet(const State& start) {
    world_.setGravity({0, -9.81, 0});
    add(ground_, 0, {0, -1, 0});
    const auto x = start.f64(rigid3d_columns::position);
    for (size_t i = 3; i < x.size(); i += 3) {
      add(box_, 1000, {btScalar(x[i]), btScalar(x[i + 1]), btScalar(x[i + 2])});
    }
  }
  ~Bullet() {
    for (const auto& b : bodies_) world_.removeRigidBody(b.get());
  }
  void run(int steps) {
    for (int k = 0; k < steps; ++k) world_.stepSimulation(kStep, 0);
  }

 private:
  void add(btCollisionShape& shape, btScalar mass, const btVector3& at) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape.calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
    info.m_startWorldTransform.setOrigin(at);
    info.m_friction = std::sqrt(btScalar(0.5));
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(bodies_.back().get());
  }
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broad_phase_, &solver_, &configuration_};
  btBoxShape ground_{{100, 1, 100}}, box_{{0.5, 0.5, 0.5}};
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};
#endif

}  // namespace

int main() {
  Rigid3dDef def = pyramid();
  def.sleeping = false;
  Ours floats(def);
  floats.run(kSettle);
  {
    def.precision = Rigid3dDef::Precision::f64;
    Ours doubles(def);
    doubles.run(kSettle);
    const auto t = bench::paired(
        kRounds, [&] { floats.run(kSteps); }, [&] { doubles.run(kSteps); }, bench::thread_seconds);
    compare("CPU seconds per step, 1240 boxes", "the same in f64", t.times, floats.observed("penetration"),
            doubles.observed("penetration"));
  }
  {
    Ours asleep(pyramid());
    asleep.run(600);
    const auto t = bench::paired(
        kRounds, [&] { asleep.run(kSteps); }, [&] { floats.run(kSteps); }, bench::thread_seconds);
    compare("CPU seconds per step, asleep", "the same awake", t.times);
  }
#ifdef TRUESTEP_BULLET
  Bullet bullet(Ours(def).state);
  bullet.run(kSettle);
  const auto t = bench::paired(
      kRounds, [&] { floats.run(kSteps); }, [&] { bullet.run(kSteps); }, bench::thread_seconds);
  compare("CPU seconds per step, 1240 boxes", "Bullet", t.times);
#endif
}
