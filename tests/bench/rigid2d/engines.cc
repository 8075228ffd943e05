#include "tests/bench/rigid2d/engines.h"

#include <dlfcn.h>

#include <cstdio>

#ifdef TRUESTEP_BOX2D
#include <box2d/box2d.h>
#endif

#include "engine/systems/rigid2d/rigid2d.h"

namespace truestep::bench {
namespace {

bool sleeps(const FlatBody& b, Sleep sleep) {
  return b.kind == FlatBody::Kind::sleeper || b.kind == FlatBody::Kind::asleep || sleep == Sleep::allowed;
}

struct Ours final : FlatEngine {
  Ours(const FlatScene& scene, Sleep sleep) {
    rigid2d::Rigid2dDef def;
    for (const FlatBody& b : scene.bodies) {
      rigid2d::BodyDef d;
      d.motion = b.kind == FlatBody::Kind::fixed ? rigid2d::Motion::fixed : rigid2d::Motion::dynamic;
      d.position = {b.x, b.y, 0}, d.angle = b.angle;
      d.velocity = {b.vx, 0, 0}, d.angular_velocity = b.spin, d.friction = kFlatFriction;
      d.can_sleep = sleeps(b, sleep), d.asleep = b.kind == FlatBody::Kind::asleep;
      if (!scene.collide) d.mask = 0;
      for (const FlatShape& h : b.shapes) {
        d.density = h.density;
        if (!h.corners.empty()) {
          rigid2d::PolygonDef polygon;
          for (const auto& [x, y] : h.corners) polygon.points.push_back({x, y, 0});
          d.shapes.push_back(polygon);
        } else if (h.hx == 0) {
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
    context.gravity = {0, scene.gravity, 0}, context.dt = kFlatDt;
    system = std::make_unique<rigid2d::Rigid2d>(def, context);
    state = system->initial_state();
  }
  void step() override {
    system->step(state, {static_cast<double>(count) * kFlatDt, kFlatDt, count, workspace, arena});
    ++count;
  }
  FlatState look(size_t i) const override {
    const auto x = state.f64(state.at("position")), v = state.f64(state.at("velocity"));
    return {{x[3 * i], x[3 * i + 1], state.f64(state.at("angle"))[i]},
            v[3 * i],
            v[3 * i + 1],
            state.f64(state.at("angular_velocity"))[i]};
  }
  bool asleep(size_t i) const override {
    std::vector<double> scratch;
    const FieldPlace at = system->find_field("asleep").value();
    return static_cast<const double*>(system->field(state, at.part, at.field, scratch).data)[i] != 0;
  }
  std::unique_ptr<rigid2d::Rigid2d> system;
  State state;
  Workspace workspace;
  ThreadArena arena{1};
  uint64_t count = 0;
};

struct Peer final : FlatEngine {
  Peer(const FlatLibrary& l, const FlatScene& scene, Sleep sleep)
      : library(l), world(l.create(0, scene.gravity)) {
    for (const FlatBody& b : scene.bodies) {
      const double place[] = {b.x, b.y, b.angle, b.vx, b.spin};
      const int rest = b.kind == FlatBody::Kind::asleep ? 2 : sleeps(b, sleep) ? 1 : 0;
      const int id = l.body(world, b.kind != FlatBody::Kind::fixed, place, rest);
      for (const FlatShape& h : b.shapes) {
        const double box[] = {h.hx, h.hy, h.cx, h.cy};
        l.shape(world, id, box, static_cast<int>(h.corners.size()),
                h.corners.empty() ? nullptr : h.corners[0].data(), h.density, kFlatFriction, scene.collide);
      }
    }
    for (const FlatJoint& j : scene.joints)
      l.revolute(world, j.a, j.b, j.ax, j.ay, j.bx, j.by, j.speed, j.torque);
  }
  void step() override { library.step(world, kFlatDt); }
  FlatState look(size_t i) const override {
    double m[6];
    library.motion(world, static_cast<int>(i), m);
    return {{m[0], m[1], m[2]}, m[3], m[4], m[5]};
  }
  bool asleep(size_t i) const override { return library.asleep(world, static_cast<int>(i)) != 0; }
  const FlatLibrary& library;
  void* world;  // lives as long as the process
};

#ifdef TRUESTEP_BOX2D
struct Box2d final : FlatEngine {
  Box2d(const FlatScene& scene, Sleep sleep) : world(b2Vec2(0, static_cast<float>(scene.gravity))) {
    const auto f = [](double x) { return static_cast<float>(x); };
    for (const FlatBody& b : scene.bodies) {
      b2BodyDef d;
      d.type = b.kind == FlatBody::Kind::fixed ? b2_staticBody : b2_dynamicBody;
      d.position.Set(f(b.x), f(b.y)), d.angle = f(b.angle);
      d.linearVelocity.Set(f(b.vx), 0), d.angularVelocity = f(b.spin);
      d.allowSleep = sleeps(b, sleep), d.awake = b.kind != FlatBody::Kind::asleep;
      bodies.push_back(world.CreateBody(&d));
      for (const FlatShape& h : b.shapes) {
        b2FixtureDef fixture;
        fixture.density = f(h.density), fixture.friction = f(kFlatFriction);
        if (!scene.collide) fixture.filter.maskBits = 0;
        b2PolygonShape polygon;
        b2CircleShape disk;
        b2EdgeShape edge;
        if (!h.corners.empty()) {
          std::vector<b2Vec2> corners;
          for (const auto& [x, y] : h.corners) corners.push_back({f(x), f(y)});
          polygon.Set(corners.data(), static_cast<int32>(corners.size())), fixture.shape = &polygon;
        } else if (h.hx == 0) {
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
  void step() override { world.Step(static_cast<float>(kFlatDt), 8, 3); }
  FlatState look(size_t i) const override {
    const b2Vec2 p = bodies[i]->GetPosition(), v = bodies[i]->GetLinearVelocity();
    return {{p.x, p.y, bodies[i]->GetAngle()}, v.x, v.y, bodies[i]->GetAngularVelocity()};
  }
  bool asleep(size_t i) const override { return !bodies[i]->IsAwake(); }
  b2World world;
  std::vector<b2Body*> bodies;
};
#endif

}  // namespace

bool FlatLibrary::open(const char* path) {
  void* handle = dlopen(path, RTLD_NOW);
  if (!handle) return false;
  const auto find = [&](auto& f, const char* symbol) {
    f = reinterpret_cast<std::remove_reference_t<decltype(f)>>(dlsym(handle, symbol));
    return f != nullptr;
  };
  return find(create, "peer_new") && find(body, "peer_body") && find(shape, "peer_shape") &&
         find(revolute, "peer_revolute") && find(step, "peer_step") && find(motion, "peer_motion") &&
         find(asleep, "peer_asleep");
}

std::unique_ptr<FlatEngine> FlatLibrary::make(const FlatScene& scene, Sleep sleep) const {
  return std::make_unique<Peer>(*this, scene, sleep);
}

std::unique_ptr<FlatEngine> make_ours(const FlatScene& scene, Sleep sleep) {
  return std::make_unique<Ours>(scene, sleep);
}

std::unique_ptr<FlatEngine> make_box2d([[maybe_unused]] const FlatScene& scene,
                                       [[maybe_unused]] Sleep sleep) {
#ifdef TRUESTEP_BOX2D
  return std::make_unique<Box2d>(scene, sleep);
#else
  return nullptr;
#endif
}

std::vector<FlatLibrary> open_flat_libraries(const std::vector<char*>& arguments) {
  std::vector<FlatLibrary> libraries;
  for (const std::string argument : arguments) {
    const size_t equals = argument.find('=');
    FlatLibrary library;
    library.name = argument.substr(0, equals);
    if (library.open(argument.c_str() + equals + 1)) {
      libraries.push_back(library);
    } else {
      std::fprintf(stderr, "%s: no such peer\n", argument.c_str());
    }
  }
  return libraries;
}

}  // namespace truestep::bench
