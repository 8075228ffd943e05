// What moved shapes give out: their poses, the surfaces of those that are stretched, and controls.
#include "engine/animation/driver_outputs.h"
#include "engine/systems/keyframes/keyframes.h"

namespace truestep::keyframes {

using C = MovedColumns;

const OutputTable& Keyframes::outputs() {
  using K = Keyframes;
  const auto skins = [](const K& k) {
    std::vector<PartInfo> parts;
    for (const size_t i : k.stretched_) {
      parts.push_back(points_part(k.shapes_[i].vertices.size()));
      parts.back().name = k.shapes_[i].def.id;
    }
    return parts;
  };
  const auto vertices = [](const K& k, const State&, size_t part) {
    const Shape& shape = k.shapes_[k.stretched_[part]];
    return ShownRows{shape.first_vertex, shape.vertices.size()};
  };
  const auto names = [](const K& k) {
    std::vector<std::string> out;
    for (const size_t i : k.named_) out.push_back(k.shapes_[i].def.id);
    return out;
  };
  const auto places = [](const K& k, const State& s, double, size_t member) {
    return animation::Place{load3(s.f64(C::kBodies.position).data(), k.named_[member])};
  };
  static const OutputTable kTable =
      OutputsOf<K>("a shape; in a part named after a shape, one of its vertices; in part controls a control")
          .part("", [](const K& k) { return points_part(k.shapes_.size()); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(C::kBodies.position),
                 "of the centre, or of a vertex")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(C::kBodies.velocity),
                 "mean over the last step")
          .field({"orientation", "1", Scalar::f64, 4, Meaning::orientation}, column(C::kBodies.orientation),
                 "w, x, y, z")
          .field({"angular_velocity", "rad/s", Scalar::f64, 3}, column(C::kBodies.angular_velocity),
                 "mean over the last step, in the world")
          .part("<shape>", skins)
          .rows(vertices)
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(C::kSkin), "")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(C::kSkinVelocity), "")
          .part("controls",
                [](const K& k) {
                  const size_t n = k.driver_.controls();
                  return n > 0 ? std::optional(values_part(n)) : std::nullopt;
                })
          .field({"controls.value", "1"}, column(C::kValue),
                 "of part controls, one row per control: its value")
          .measured_each(animation::control_names(&K::driver_),
                         animation::control_values(&K::driver_, C::kControl), animation::kControlRows)
          .measured_each(names, places, {{"shape.<id>", "m", &animation::Place::x, "position of a shape"}})
          .build();
  return kTable;
}

const Outputs& keyframes_outputs() {
  static const Outputs kDescribed = Keyframes::outputs().described();
  return kDescribed;
}

}  // namespace truestep::keyframes
