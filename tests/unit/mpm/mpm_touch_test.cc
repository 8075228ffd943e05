// Nodes and a rigid body that push each other, against closed forms and conservation laws.
#include <gtest/gtest.h>

#include <vector>

#include "engine/kernels/mpm/touch.h"

namespace truestep::mpm {
namespace {

TouchedBody ball(double mass) {
  const double i = 0.4 * mass * 0.01;
  return {mass, {Vec3{i, 0, 0}, Vec3{0, i, 0}, Vec3{0, 0, i}}, {0, -2, 0}, {1, 0, 0.5}};
}
std::vector<TouchedNode> some_nodes() {
  std::vector<TouchedNode> out;
  for (const Vec3& n : {Vec3{0, -1, 0}, Vec3{0.6, -0.8, 0}, Vec3{0, -0.8, -0.6}, Vec3{0.8, 0.6, 0}}) {
    out.push_back({0.7, n * 0.09, n, {0.3, 0.1, -0.2}, {}, false});
  }
  return out;
}

// A node under the centre of a ball: a plastic impact, (m v + M u) / (m + M).
TEST(MpmTouch, ANodeInTheWayMovesOnWithTheBody) {
  for (const double mass : {1e-3, 1.0, 1e3}) {
    TouchedBody body = ball(mass);
    body.spin = {};
    TouchedNode node{0.5, {0, -0.1, 0}, {0, -1, 0}, {0.2, 1, 0}, {}, false};
    touch({&node, 1}, body, Hold::separate, 0);
    const double together = (0.5 * 1 - mass * 2) / (0.5 + mass);
    EXPECT_NEAR(node.velocity.y, together, 1e-14);
    EXPECT_NEAR(body.velocity.y, together, 1e-14);
    EXPECT_EQ(node.velocity.x, 0.2) << "nothing holds it along the ball";
  }
}

TEST(MpmTouch, WhatLeavesIsLetGo) {
  TouchedBody body = ball(1);
  TouchedNode node{0.5, {0, -0.1, 0}, {0, -1, 0}, {0, -3, 0}, {}, false};
  touch({&node, 1}, body, Hold::separate, 1);
  EXPECT_EQ(node.velocity.y, -3);
  EXPECT_EQ(body.velocity.y, -2);
  touch({&node, 1}, body, Hold::slip, 0);
  EXPECT_NEAR(node.velocity.y, body.velocity.y, 1e-14) << "slip holds it";
}

TEST(MpmTouch, MomentumIsExchangedToRounding) {
  for (const Hold kind : {Hold::sticky, Hold::slip, Hold::separate}) {
    for (const double friction : {0.0, 0.3, 10.0}) {
      TouchedBody body = ball(2);
      const TouchedBody start = body;
      auto nodes = some_nodes();
      const auto before = nodes;
      touch(nodes, body, kind, friction);
      Vec3 p = (body.velocity - start.velocity) * body.mass,
           l = (body.spin - start.spin) * start.inertia[0].x;
      for (size_t k = 0; k < nodes.size(); ++k) {
        const Vec3 gain = (nodes[k].velocity - before[k].velocity) * nodes[k].mass;
        p += gain, l += cross(nodes[k].arm, gain);
      }
      EXPECT_LT(norm(p), 1e-14);
      EXPECT_LT(norm(l), 1e-15);
      EXPECT_GT(norm(body.velocity - start.velocity), 0.1) << "control: they push";
    }
  }
}

// The body has a thousandth of the mass around it: it must reach the nodes' velocity, not exceed it.
TEST(MpmTouch, ALightBodyDoesNotOvershoot) {
  TouchedBody body = ball(2.8e-3);
  auto nodes = some_nodes();
  touch(nodes, body, Hold::sticky, 0);
  for (const TouchedNode& n : nodes) {
    EXPECT_LT(norm(n.velocity - Vec3{0.3, 0.1, -0.2}), 0.01);
    EXPECT_LT(norm(body.velocity + cross(body.spin, n.arm) - n.velocity), 1e-12);
  }
  body = ball(2.8e-3), nodes = some_nodes();
  touch(nodes, body, Hold::separate, 0.5);
  for (const TouchedNode& n : nodes) {
    const double approach = dot(body.velocity + cross(body.spin, n.arm) - n.velocity, n.normal);
    EXPECT_LT(approach, 1e-12);
    EXPECT_GE(dot(n.impulse, n.normal), -1e-15) << "nothing is pulled";
  }
}

TEST(MpmTouch, FrictionStaysWithinCoulombsCone) {
  for (const double friction : {0.05, 0.3, 5.0}) {
    TouchedBody body = ball(2);
    auto nodes = some_nodes();
    const double sideways = nodes[0].velocity.x;
    touch(nodes, body, Hold::separate, friction);
    for (const TouchedNode& n : nodes) {
      const double push = dot(n.impulse, n.normal);
      // The body's response makes sliding slower than the bound was computed from, never faster.
      EXPECT_LE(norm(n.impulse - n.normal * push), friction * push + 1e-14);
    }
    EXPECT_NE(nodes[0].velocity.x, sideways) << "control: it is dragged along";
  }
}

// A driven body keeps its motion, and nodes take it over.
TEST(MpmTouch, ADrivenBodyKeepsItsMotion) {
  TouchedBody body = ball(0);
  auto nodes = some_nodes();
  touch(nodes, body, Hold::sticky, 0);
  EXPECT_EQ(body.velocity.y, -2);
  for (const TouchedNode& n : nodes)
    EXPECT_LT(norm(body.velocity + cross(body.spin, n.arm) - n.velocity), 1e-15);
}

}  // namespace
}  // namespace truestep::mpm
