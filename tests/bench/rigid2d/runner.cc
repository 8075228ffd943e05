// rigid2d_runner [NAME=LIBRARY]...: rigid bodies in the plane beside Rapier2d and Box2D v3 (libraries of
// peers/rapier2d and peers/box2d3) and, where it is installed, Box2D 2.4. Engines take turns of ten steps on
// the same scene; milliseconds of one thread per step beside the worst overlap or joint gap at twenty moments
// of the last three quarters.
#include <dlfcn.h>

#include <cstdio>
#include <memory>

#ifdef TRUESTEP_BOX2D
#include <box2d/box2d.h>
#endif

#include "engine/systems/rigid2d/rigid2d.h"
#include "tests/bench/report.h"
#include "tests/bench/rigid2d/scenes.h"

namespace truestep::bench {
namespace {

constexpr double kDt = 1.0 / 60, kFriction = 0.6;
constexpr int kTurn = 10;

struct Engine {
  virtual ~Engine() = default;
  virtual void step() = 0;
  virtual FlatPose pose(size_t body) const = 0;
};

struct Ours final : Engine {
  explicit Ours(const FlatScene& scene) {
    rigid2d::Rigid2dDef def;
    for (const FlatBody& b : scene.bodies) {
      rigid2d::BodyDef d;
      d.motion = b.kind == FlatBody::Kind::fixed ? rigid2d::Motion::fixed : rigid2d::Motion::dynamic;
      d.position = {b.x, b.y, 0}, d.velocity = {b.vx, 0, 0}, d.friction = kFriction;
      d.can_sleep = d.asleep = b.kind == FlatBody::Kind::asleep;
      if (!scene.collide) d.mask = 0;
      for (const FlatShape& h : b.shapes) {
        d.density = h.density;
        if (h.hx == 0) {
          d.shapes.push_back(rigid2d::CircleDef{h.hy, {h.cx, h.cy, 0}});
        } else if (h.hy == 0) {
          d.shapes.push_back(rigid2d::ChainDef{{{h.cx - h.hx, h.cy, 0}, {h.cx + h.hx, h.cy, 0}}, false});
        } else {
          d.shapes.push_back(rigid2d::BoxDef{{h.hx, h.hy, 0}, {h.cx, h.cy, 0}});
        }
      }
      def.bodies.push_back(d);
    }
    for (const FlatJoint& j : scene.joints) {
      const FlatBody &a = scene.bodies[static_cast<size_t>(j.a)], &b = scene.bodies[static_cast<size_t>(j.b)];
      if (a.kind == FlatBody::Kind::fixed && b.kind == FlatBody::Kind::fixed) continue;
      rigid2d::RevoluteDef r;
      r.a = j.a, r.b = j.b, r.anchor = {a.x + j.ax, a.y + j.ay, 0};
      if (j.torque > 0) r.motor_speed = j.speed, r.max_motor = j.torque;
      def.joints.push_back(r);
    }
    BuildContext context;
    context.gravity = {0, scene.gravity, 0}, context.dt = kDt;
    system = std::make_unique<rigid2d::Rigid2d>(def, context);
    state = system->initial_state();
  }
  void step() override {
    system->step(state, {static_cast<double>(count) * kDt, kDt, count, workspace, arena});
    ++count;
  }
  FlatPose pose(size_t i) const override {
    const auto x = state.f64(state.at("position"));
    return {x[3 * i], x[3 * i + 1], state.f64(state.at("angle"))[i]};
  }
  std::unique_ptr<rigid2d::Rigid2d> system;
  State state;
  Workspace workspace;
  ThreadArena arena{1};
  uint64_t count = 0;
};

struct Peer final : Engine {
  struct Library {
    std::string name;
    void* (*create)(double, double);
    int (*body)(void*, int, double, double, double, int);
    void (*shape)(void*, int, double, double, double, double, double, double, int);
    void (*revolute)(void*, int, int, double, double, double, double, double, double);
    void (*step)(void*, double);
    void (*pose)(void*, int, double*);
    /// False when the library is not there or is another one.
    bool open(const char* path) {
      void* handle = dlopen(path, RTLD_NOW);
      if (!handle) return false;
      const auto find = [&](auto& f, const char* name) {
        f = reinterpret_cast<std::remove_reference_t<decltype(f)>>(dlsym(handle, name));
        return f != nullptr;
      };
      return find(create, "peer_new") && find(body, "peer_body") && find(shape, "peer_shape") &&
             find(revolute, "peer_revolute") && find(step, "peer_step") && find(pose, "peer_pose");
    }
  };
  Peer(const Library& l, const FlatScene& scene) : library(l), world(l.create(0, scene.gravity)) {
    for (const FlatBody& b : scene.bodies) {
      const int id =
          l.body(world, b.kind != FlatBody::Kind::fixed, b.x, b.y, b.vx, b.kind == FlatBody::Kind::asleep);
      for (const FlatShape& h : b.shapes)
        l.shape(world, id, h.hx, h.hy, h.cx, h.cy, h.density, kFriction, scene.collide);
    }
    for (const FlatJoint& j : scene.joints)
      l.revolute(world, j.a, j.b, j.ax, j.ay, j.bx, j.by, j.speed, j.torque);
  }
  void step() override { library.step(world, kDt); }
  FlatPose pose(size_t i) const override {
    double p[3];
    library.pose(world, static_cast<int>(i), p);
    return {p[0], p[1], p[2]};
  }
  const Library& library;
  void* world;
};

#ifdef TRUESTEP_BOX2D
struct Box2d final : Engine {
  explicit Box2d(const FlatScene& scene) : world(b2Vec2(0, static_cast<float>(scene.gravity))) {
    const auto f = [](double x) { return static_cast<float>(x); };
    for (const FlatBody& b : scene.bodies) {
      b2BodyDef d;
      d.type = b.kind == FlatBody::Kind::fixed ? b2_staticBody : b2_dynamicBody;
      d.position.Set(f(b.x), f(b.y));
      d.linearVelocity.Set(f(b.vx), 0);
      d.allowSleep = b.kind == FlatBody::Kind::asleep, d.awake = !d.allowSleep;
      bodies.push_back(world.CreateBody(&d));
      for (const FlatShape& h : b.shapes) {
        b2FixtureDef fixture;
        fixture.density = f(h.density), fixture.friction = f(kFriction);
        if (!scene.collide) fixture.filter.maskBits = 0;
        b2PolygonShape polygon;
        b2CircleShape disk;
        b2EdgeShape edge;
        if (h.hx == 0) {
          disk.m_radius = f(h.hy), fixture.shape = &disk;
        } else if (h.hy == 0) {
          edge.SetTwoSided({f(h.cx - h.hx), f(h.cy)}, {f(h.cx + h.hx), f(h.cy)});
          fixture.shape = &edge;
        } else {
          polygon.SetAsBox(f(h.hx), f(h.hy), {f(h.cx), f(h.cy)}, 0);
          fixture.shape = &polygon;
        }
        bodies.back()->CreateFixture(&fixture);
      }
    }
    for (const FlatJoint& j : scene.joints) {
      b2RevoluteJointDef d;
      d.bodyA = bodies[static_cast<size_t>(j.a)], d.bodyB = bodies[static_cast<size_t>(j.b)];
      d.localAnchorA.Set(f(j.ax), f(j.ay)), d.localAnchorB.Set(f(j.bx), f(j.by));
      d.enableMotor = j.torque > 0, d.motorSpeed = f(j.speed), d.maxMotorTorque = f(j.torque);
      world.CreateJoint(&d);
    }
  }
  void step() override { world.Step(static_cast<float>(kDt), 8, 3); }
  FlatPose pose(size_t i) const override {
    const b2Vec2 p = bodies[i]->GetPosition();
    return {p.x, p.y, bodies[i]->GetAngle()};
  }
  b2World world;
  std::vector<b2Body*> bodies;
};
#endif

struct Player {
  std::string name;
  std::unique_ptr<Engine> engine;
  double seconds = 0, error = 0;
};

void play(const FlatScene& scene, std::vector<Player>& players) {
  std::vector<FlatPose> poses(scene.bodies.size());
  const int every = scene.steps / 20;
  for (int done = 0; done < scene.steps; done += kTurn) {
    for (Player& p : players) {
      const double start = thread_seconds();
      for (int k = 0; k < kTurn; ++k) p.engine->step();
      p.seconds += thread_seconds() - start;
      if (4 * done < scene.steps || done % every >= kTurn) continue;
      for (size_t i = 0; i < poses.size(); ++i) poses[i] = p.engine->pose(i);
      p.error = std::max(p.error, flat_error(scene, poses));
    }
  }
  for (size_t i = 1; i < players.size(); ++i) {
    report({.bench = "rigid2d",
            .metric = scene.name + ", ms per step",
            .ours = 1e3 * players[0].seconds / scene.steps,
            .peer = 1e3 * players[i].seconds / scene.steps,
            .peer_name = players[i].name,
            .error_ours = players[0].error,
            .error_peer = players[i].error});
  }
}

}  // namespace
}  // namespace truestep::bench

int main(int count, char** arguments) {
  using namespace truestep::bench;
  std::vector<Peer::Library> libraries;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    const size_t equals = argument.find('=');
    Peer::Library library{};
    library.name = argument.substr(0, equals);
    if (equals != std::string::npos && library.open(argument.c_str() + equals + 1)) {
      libraries.push_back(library);
    } else {
      std::fprintf(stderr, "%s: no such peer\n", arguments[i]);
    }
  }
  for (const FlatScene& scene : flat_scenes()) {
    std::vector<Player> players;
    players.push_back({"Truestep", std::make_unique<Ours>(scene)});
    for (const Peer::Library& l : libraries) players.push_back({l.name, std::make_unique<Peer>(l, scene)});
#ifdef TRUESTEP_BOX2D
    players.push_back({"Box2D 2.4", std::make_unique<Box2d>(scene)});
#endif
    play(scene, players);
  }
}
