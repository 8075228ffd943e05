// Box2D's world of one state: built from it, stepped, and read back into it.
#pragma once
#include <box2d/box2d.h>

#include <memory>
#include <set>
#include <vector>

#include "engine/core/def/build.h"
#include "engine/core/state/state.h"
#include "engine/systems/rigid2d/model.h"

namespace truestep::reference {

/// What a world is made from; constant.
struct Box2dScene {
  Box2dScene(const rigid2d::Rigid2dDef& def, const BuildContext& context);

  rigid2d::Model model;
  double restitution_speed, parts;  ///< parts: the step length that impulses in the state refer to is dt /
                                    ///< parts
  double dt;                        ///< s
  bool sleeping;
};

class Box2dWorld final : private b2ContactFilter, private b2ContactListener {
 public:
  Box2dWorld(std::shared_ptr<const Box2dScene> scene, const State& state);

  /// True when it belongs to this scene and nothing but sleep differs from what was last read back.
  bool matches(const Box2dScene& scene, const State& s) const;
  /// One step of h (s) with the state's gravity, pushes and drags.
  void step(State& s, double h);

 private:
  void add_body(const State& s, size_t i);
  void add_shape(b2Body& body, const rigid2d::Shape& shape, uint32_t number);
  std::vector<b2Joint*> take_hands(State& s, double h);
  void read_joints(State& s, double h);
  void read_bodies(State& s);
  void read_contacts(State& s);
  void remember(const State& s);
  bool ShouldCollide(b2Fixture* a, b2Fixture* b) override;
  void PreSolve(b2Contact* contact, const b2Manifold* old) override;
  void EndContact(b2Contact* contact) override;

  std::shared_ptr<const Box2dScene> scene_;
  b2World world_{b2Vec2(0, 0)};
  std::vector<b2Body*> bodies_;  ///< the ground body comes last
  std::vector<b2Joint*> joints_;
  std::set<uint64_t> passing_;  ///< pairs of shapes, one of which lets the other through
  std::vector<double> read_;
  std::vector<uint32_t> marks_;  ///< pinned, removed; broken
  struct Row {
    uint64_t key;
    float impulse[5];
  };
  std::vector<Row> contacts_;
};

}  // namespace truestep::reference
