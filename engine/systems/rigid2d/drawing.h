// How bodies of the plane are drawn: tiles with a bevelled rim, a disk with a notch that shows its turning.
// Rows of the system's fields are the bodies first and the drawing's vertices after them.
#pragma once
#include <vector>

#include "engine/core/topology.h"
#include "engine/systems/rigid2d/model.h"

namespace truestep::rigid2d {

struct Vertex {
  uint32_t body = 0;
  Vec2 local;        ///< about the body's centre of mass
  double depth = 0;  ///< m towards the viewer
};

struct Drawing {
  std::vector<Vertex> rows;  ///< of the fields: rows[i] for i < bodies is the centre of body i
  Topology topology;
};

Drawing draw(const Model& model, const std::optional<Vec3>& color);

}  // namespace truestep::rigid2d
