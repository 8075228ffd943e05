#include "engine/systems/grid_fluid/moving_solids.h"

#include <algorithm>
#include <cmath>

#include "engine/systems/grid_fluid/flow.h"

namespace truestep::grid_fluid {

namespace {
double axis_component(const Vec3& v, size_t c) {
  return c == 0 ? v.x : c == 1 ? v.y : v.z;
}
}  // namespace

void MovingSolids::bind(const FlowModel& m) {
  model_ = &m, solids_ = &m.solids, places_ = {}, time_ = 0;
  if (!m.solids.any()) return;
  m.texts.place_obstacles(m.def.obstacles, 0, places_);
  if (!m.texts.obstacles_move) return;
  moving_ = m.solids, solids_ = &moving_;
  moving_.set_aside();
}

bool MovingSolids::place(double t) {
  if (!model_->texts.obstacles_move || time_ == t) return false;
  model_->texts.place_obstacles(model_->def.obstacles, t, places_);
  moving_.place(places_.obstacles, model_->grid);
  time_ = t;
  return true;
}

Vec3 MovingSolids::velocity(uint32_t n, const Vec3& at) const {
  const Vec3& spin = places_.spin[n];
  if (spin == Vec3{}) return places_.velocity[n];
  return places_.velocity[n] + cross(spin, at - places_.obstacles[n].center);
}

double MovingSolids::velocity(const Solids::Face& face, size_t c) const {
  if (places_.spin[face.obstacle] == Vec3{}) return axis_component(places_.velocity[face.obstacle], c);
  return axis_component(velocity(face.obstacle, model_->grid.position(c, face.at)), c);
}

double MovingSolids::crossing_rate() const {
  const mac::MacGrid& g = model_->grid;
  double most = 0;
  for (size_t n = 0; n < places_.velocity.size(); ++n) {
    const ObstacleDef& o = places_.obstacles[n];
    const double reach = o.shape == ObstacleDef::Shape::sphere ? o.radius
                         : g.dimensions == 2                   ? norm(Vec3{o.half.x, o.half.y, 0})
                                                               : norm(o.half);
    const double turning = norm(places_.spin[n]) * reach;
    double rate = 0;
    for (size_t c = 0; c < g.dimensions; ++c)
      rate += (std::abs(axis_component(places_.velocity[n], c)) + turning) / g.spacing[c];
    most = std::max(most, rate);
  }
  return most;
}

double MovingSolids::lever(const Solids::Face& face, size_t c) const {
  const ObstacleDef& o = places_.obstacles[face.obstacle];
  const Vec3 arm = model_->grid.position(c, face.at) - o.center;
  const Vec3 along{c == 0 ? 1.0 : 0.0, c == 1 ? 1.0 : 0.0, c == 2 ? 1.0 : 0.0};
  return dot(normalized(o.axis), cross(arm, along));
}

}  // namespace truestep::grid_fluid
