// What a blended surface gives out.
#include <algorithm>
#include <cmath>

#include "engine/animation/driver_outputs.h"
#include "engine/systems/blend_shapes/scratch.h"

namespace truestep::blend_shapes {

using namespace columns;

const OutputTable& BlendShapes::outputs() {
  using B = BlendShapes;
  const auto weights = [](const B& b, const State& s, double t) {
    animation::Driver::Scratch scratch;
    const auto outputs = b.driver_.outputs_at(t, s.f64(kControl), scratch);
    std::vector<animation::Named> out;
    for (const size_t k : b.weights_) out.push_back({outputs[k]});
    return out;
  };
  const auto extent = [](const B& b, const State& s, double) {
    Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
    for (size_t i = 0; i < b.base_.size(); ++i) {
      const Vec3 x = load3(s.f64(kPosition).data(), i);
      low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
      high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
    }
    return animation::Place{high - low};
  };
  static const OutputTable kTable =
      OutputsOf<B>("a vertex, in the given order; in a ball the pole, then ring by ring, then the other pole")
          .part("", [](const B& b) { return points_part(b.base_.size()); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(kPosition), "")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(kVelocity),
                 "mean over the last step")
          .measured_each(animation::control_names(&B::driver_),
                         animation::control_values(&B::driver_, kControl), animation::kControlRows)
          .measured_each([](const B& b) { return b.names_; }, weights,
                         {{"weight.<target>", "1", &animation::Named::value, "of a target"}})
          .measured(extent, {{"size", "m", &animation::Place::x, "extent of the surface"}})
          .build();
  return kTable;
}

const Outputs& blend_shapes_outputs() {
  static const Outputs kDescribed = BlendShapes::outputs().described();
  return kDescribed;
}

}  // namespace truestep::blend_shapes
