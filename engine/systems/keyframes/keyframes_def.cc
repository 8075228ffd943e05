#include "engine/systems/keyframes/keyframes_def.h"

namespace truestep::keyframes {

namespace {

const DefTable& shape_table() {
  using D = MovedShapeDef;
  static const DefTable t =
      TableOf<D>("a shape whose pose is given as expressions")
          .text("id", &D::id, "its name; with scale also the name of its part")
          .choice("shape", &D::shape, {"sphere", "box", "capsule", "cylinder"}, "axes are y")
          .number("radius", &D::radius, "m", above(0), "of sphere, capsule and cylinder")
          .number("half_length", &D::half_length, "m", above(0),
                  "of capsule (without its round ends) and cylinder")
          .vector("half_extents", &D::half_extents, "m", above(0), "of a box")
          .texts("position", &D::position, {0, 3}, "x, y and z (m) as expressions; a missing one is 0")
          .texts("rotation", &D::rotation, {0, 3}, "angles (rad) about x, y and z as expressions")
          .choice("order", &D::order, animation::kEulerOrders,
                  "of the angles, each about its axis as rotated so far")
          .text("turn", &D::turn, "name of one of turns; instead of rotation")
          .texts("scale", &D::scale, {0, 3},
                 "factors along its own axes as expressions, of spheres and boxes; a missing one is 1")
          .vector("color", &D::color, "1", between(0, 1), "linear red, green, blue")
          .check([](const D& d, const DefTable::Report& report) {
            if (!d.turn.empty() && !d.rotation.empty()) report("/turn", "give turn or rotation, not both");
            if (d.scale.empty()) return;
            if (d.shape != ShapeType::sphere && d.shape != ShapeType::box) {
              report("/scale", "only spheres and boxes can have a scale");
            }
            if (d.id.empty()) report("/id", "a shape with a scale is a part of its own and needs a name");
          })
          .build();
  return t;
}

}  // namespace

const DefTable& keyframes_table() {
  using D = KeyframesDef;
  static const DefTable t = [] {
    TableOf<D> table("shapes that move along curves and expressions, and that others collide with");
    table.objects("shapes", &D::shapes, shape_table(), {0, 10'000}, "what moves");
    animation::add_driver_rows(table);
    return table
        .check([](const D& d, const DefTable::Report& report) {
          if (d.shapes.empty() && d.controls.empty() && d.paths.empty() && d.vectors.empty() &&
              d.turns.empty())
            report("", "no shapes and no controls: nothing to animate");
        })
        .build();
  }();
  return t;
}

namespace {
constexpr double kVertices = 2 + 24 * 15;  // of a scaled sphere, keyframes.cc
}

Cost keyframes_cost(const void* def) {
  const auto& d = *static_cast<const KeyframesDef*>(def);
  const auto shapes = static_cast<double>(d.shapes.size());
  double stretched = 0, keys = 0;
  for (const MovedShapeDef& s : d.shapes) stretched += !s.scale.empty();
  for (const auto& c : d.controls) keys += static_cast<double>(c.times.size());
  for (const auto& p : d.paths) keys += 3 * static_cast<double>(p.times.size());
  for (const auto& v : d.vectors) keys += static_cast<double>(v.values.size());
  for (const auto& t : d.turns) keys += 4 * static_cast<double>(t.times.size());
  const double controls = static_cast<double>(d.controls.size());
  return {
      .state_bytes = 116 * shapes + 56 * kVertices * stretched + 8 * controls,
      .workspace_bytes = 4096 + 600 * shapes + (48 + 24) * kVertices * stretched + 32 * keys + 400 * controls,
      .elements = shapes + kVertices * stretched,
      .seconds_per_step = 1e-6 + 2e-7 * (shapes + controls) + 4e-9 * kVertices * stretched};
}

}  // namespace truestep::keyframes
