// Parameters and cost of the system type "blend_shapes".
#include "engine/systems/blend_shapes/blend_shapes.h"

namespace truestep::blend_shapes {

namespace {

constexpr Count kVertices{0, 1'000'000}, kLines{0, 1'000'000};

const DefTable& ball_table() {
  using D = BallDef;
  static const DefTable t = TableOf<D>("a ball made of rings about y, as the base")
                                .number("radius", &D::radius, "m", above(0), "its radius")
                                .integer("rings", &D::rings, between(1, 1000), "between the poles")
                                .integer("around", &D::around, between(3, 2000), "vertices of a ring")
                                .build();
  return t;
}

const DefTable& target_table() {
  using D = TargetDef;
  static const DefTable t =
      TableOf<D>("a shape to blend in")
          .text("name", &D::name, "its name in observables")
          .required()
          .expression("weight", &D::weight,
                      "of t and controls; for a corrective shape a product of other weights")
          .required()
          .vectors("vertices", &D::vertices, "m", any(), kVertices, "all of the target, in the base's order")
          .texts("offset", &D::offset, {0, 3},
                 "of x, y and z of the base (m): displacement from the base; a missing one is 0")
          .texts("gltf", &D::gltf, kLines,
                 "a mesh with its vertices in the base's order: a .gltf file with embedded data, or a .glb "
                 "file in base64, with any line breaks")
          .text("mesh", &D::mesh, "name of the mesh in that file; the first if absent")
          .check([](const D& d, const DefTable::Report& report) {
            if (!d.vertices.empty() + !d.offset.empty() + !d.gltf.empty() > 1)
              report("", "a target needs exactly one of vertices, offset and file");
            if (!d.mesh.empty() && d.gltf.empty()) report("/mesh", "only with a file");
          })
          .build();
  return t;
}

}  // namespace

const DefTable& blend_shapes_table() {
  using D = BlendShapesDef;
  static const DefTable t = [] {
    TableOf<D> table("a surface that is a weighted sum of shapes");
    table.vectors("vertices", &D::vertices, "m", any(), kVertices, "of the base")
        .integers("triangles", &D::triangles, at_least(0), {0, 6'000'000}, "three vertices each")
        .object("ball", &D::ball, ball_table(), "a ball as the base, instead of vertices and triangles")
        .texts("gltf", &D::gltf, kLines,
               "a mesh as the base, with targets of the same names: a .gltf file with embedded data, or a "
               ".glb file in base64, with any line breaks")
        .text("mesh", &D::mesh, "name of the mesh in that file; the first if absent")
        .texts("base", &D::base, {0, 3},
               "reshapes the base: its x, y and z as expressions of x, y and z; a missing one is unchanged")
        .objects("targets", &D::targets, target_table(), {0, 1000}, "shapes to blend in")
        .texts("position", &D::position, {0, 3}, "x, y and z (m) of the whole, as expressions")
        .texts("rotation", &D::rotation, {0, 3}, "angles (rad) about x, y and z of the whole, as expressions")
        .choice("order", &D::order, animation::kEulerOrders, "of the angles")
        .vector("color", &D::color, "1", between(0, 1), "linear red, green, blue");
    animation::add_driver_rows(table);
    return table
        .check([](const D& d, const DefTable::Report& report) {
          if (!d.vertices.empty() + d.ball.has_value() + !d.gltf.empty() != 1)
            report("", "the base needs exactly one of vertices, ball and file");
          if (!d.mesh.empty() && d.gltf.empty()) report("/mesh", "only with a file");
          if (!d.gltf.empty() && !d.triangles.empty()) report("/triangles", "the file gives these");
          if (d.triangles.size() % 3 != 0) report("/triangles", "three vertices per triangle");
          for (size_t i = 0; d.gltf.empty() && i < d.triangles.size(); ++i) {
            if (static_cast<size_t>(d.triangles[i]) < d.vertices.size()) continue;
            return report("/triangles/" + std::to_string(i), "there is no such vertex");
          }
          for (size_t k = 0; k < d.targets.size(); ++k) {
            const TargetDef& target = d.targets[k];
            const size_t n = target.vertices.size();
            if (n == 0 && target.offset.empty() && target.gltf.empty() && d.gltf.empty())
              report("/targets/" + std::to_string(k),
                     "a target needs exactly one of vertices, offset and file");
            if (!d.gltf.empty()) continue;
            const size_t want =
                d.ball ? 2 + static_cast<size_t>(d.ball->rings) * static_cast<size_t>(d.ball->around)
                       : d.vertices.size();
            if (n == 0 || n == want) continue;
            report("/targets/" + std::to_string(k) + "/vertices",
                   "needs as many as the base has, " + std::to_string(want));
          }
        })
        .build();
  }();
  return t;
}

Cost blend_shapes_cost(const void* def) {
  const auto& d = *static_cast<const BlendShapesDef*>(def);
  double n = static_cast<double>(d.vertices.size());
  if (!d.gltf.empty()) {
    // Three f32 per vertex and target, and two triangles with indices of 16 or 32 bits per vertex, in base64.
    double text = 0;
    for (const std::string& line : d.gltf) text += static_cast<double>(line.size());
    n = 0.75 * text / (30 + 12 * static_cast<double>(d.targets.size()));
  }
  if (d.ball) n = 2 + static_cast<double>(d.ball->rings) * d.ball->around;
  const auto targets = static_cast<double>(d.targets.size()),
             controls = static_cast<double>(d.controls.size());
  double keys = 0;
  for (const auto& c : d.controls) keys += static_cast<double>(c.times.size());
  // Two triangles per vertex; a target moves half of the base.
  return {.state_bytes = 56 * n + 8 * controls,
          .workspace_bytes =
              4096 + (48 + 24 + 24) * n + 14 * n * targets + 400 * (controls + targets) + 32 * keys,
          .elements = n,
          .seconds_per_step = 1e-6 + 1e-8 * n + 1e-9 * n * targets + 1e-7 * controls};
}

}  // namespace truestep::blend_shapes
