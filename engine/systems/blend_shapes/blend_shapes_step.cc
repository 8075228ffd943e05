// A step: the base, the targets by their weights, and the placement of the whole.
#include "engine/animation/moved_bodies.h"
#include "engine/systems/blend_shapes/scratch.h"

namespace truestep::blend_shapes {

using namespace animation;
using namespace columns;

void BlendShapes::update(State& s, double t, double h, Scratch& scratch) const {
  const auto out = driver_.evaluate(t, s.f64(kControl), scratch.driver);
  std::vector<double>& x = scratch.x;
  x.resize(3 * base_.size());
  for (size_t i = 0; i < base_.size(); ++i) store3(x.data(), i, base_[i]);
  for (size_t k = 0; k < targets_.size(); ++k) add_shape(targets_[k], out[weights_[k]], x.data());
  const Vec3 move = load3(&out[position_], 0);
  const Rotation turn = rotation(euler_rotation(order_, load3(&out[rotation_], 0)));
  for (size_t i = 0; i < base_.size(); ++i) store3(x.data(), i, move + turn.apply(load3(x.data(), i)));
  place_points(s.f64(kPosition), s.f64(kVelocity), x, h);
}

}  // namespace truestep::blend_shapes
