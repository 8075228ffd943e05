#include "engine/systems/skeleton/skeleton_def.h"

#include <algorithm>

#include "engine/systems/skeleton/motion_def.h"

namespace truestep::skeleton {

namespace {

const DefTable& joint_table() {
  using D = JointDef;
  static const DefTable t =
      TableOf<D>("a joint and the bones that start at it")
          .text("id", &D::id, "its name")
          .required()
          .text("parent", &D::parent, "an earlier joint; absent: the root")
          .choice("type", &D::type, {"fixed", "revolute", "prismatic", "ball"}, "kind of motion")
          .vector("offset", &D::offset, "m", any(), "in the parent's frame")
          .vector("rest_rotation", &D::rest_rotation, "rad", any(),
                  "rotation vector of its frame in the parent's, at rest")
          .vector("axis", &D::axis, "1", any(),
                  "of revolute and prismatic joints, in its own frame; twist axis of a ball; any length")
          .number("min", &D::min, "", any(), "rad or m, smallest value; of a ball smallest twist")
          .number("max", &D::max, "", any(), "rad or m, largest value; of a ball largest twist")
          .number("cone", &D::cone, "rad", between(0, 3.141592653589793),
                  "of a ball: largest swing of the axis")
          .vector("end", &D::end, "m", any(), "tip of its bone if no joint follows, in its own frame")
          .number("radius", &D::radius, "m", above(0), "of its bones; absent: bone_radius")
          .expression("value", &D::value, "rad or m, of revolute and prismatic joints")
          .texts("rotation", &D::rotation, {0, 3}, "angles (rad) about x, y and z of a ball, as expressions")
          .choice("order", &D::order, animation::kEulerOrders,
                  "of the angles, each about its axis as rotated so far")
          .text("turn", &D::turn, "of a ball: name of one of turns; instead of rotation")
          .check([](const D& d, const DefTable::Report& report) {
            using animation::JointKind;
            if (!(norm(d.axis) > 0)) report("/axis", "the axis must not be zero");
            if (d.min && d.max && *d.min > *d.max) report("/max", "the largest value is below the smallest");
            const bool ball = d.type == JointKind::ball, fixed = d.type == JointKind::fixed;
            if (!d.value.empty() && (ball || fixed))
              report("/value", "only a revolute or prismatic joint has a value");
            if (!d.rotation.empty() && !ball)
              report("/rotation", "a ball has a rotation, other joints a value");
            if (!d.turn.empty() && !ball) report("/turn", "only a ball has a turn, other joints a value");
            if (!d.turn.empty() && !d.rotation.empty()) report("/turn", "give turn or rotation, not both");
            if (d.cone && !ball) report("/cone", "a ball has a cone, other joints min and max");
          })
          .build();
  return t;
}

const DefTable& goal_table() {
  using D = GoalDef;
  static const DefTable t =
      TableOf<D>("target position for a point of a joint")
          .text("id", &D::id, "its name in observables; absent: its number")
          .text("joint", &D::joint, "the joint")
          .required()
          .text("base", &D::base, "first joint of the chain that may move; absent: the first of all")
          .vector("point", &D::point, "m", any(),
                  "the point in the joint's frame; absent: the end of its bone")
          .texts("target", &D::target, {0, 3}, "x, y and z (m) as expressions; a missing one is 0")
          .required()
          .texts("orientation", &D::orientation, {0, 3},
                 "angles (rad) about x, y and z of the joint's frame in the world, as expressions")
          .texts("pole", &D::pole, {0, 3}, "point (m) that the chain bends towards, as expressions")
          .number("weight", &D::weight, "1", above(0), "relative to other goals of the same priority")
          .number("orientation_weight", &D::orientation_weight, "m/rad", above(0),
                  "length that counts as much as a radian")
          .integer("priority", &D::priority, between(0, 9),
                   "0 goes first; later ones use the remaining freedom")
          .build();
  return t;
}

const DefTable& tube_table() {
  using D = TubeDef;
  static const DefTable t =
      TableOf<D>("a skin around the bones from one joint to another")
          .text("from", &D::from, "first joint")
          .required()
          .text("to", &D::to, "last joint, to the end of its bone; absent: from itself")
          .number("radius", &D::radius, "m", above(0), "at the first joint")
          .number("end_radius", &D::end_radius, "m", above(0), "at the end; absent: radius")
          .integer("rings", &D::rings, between(2, 1000), "along it")
          .integer("around", &D::around, between(3, 500), "vertices of a ring")
          .build();
  return t;
}

const DefTable& skin_table() {
  using D = SkinDef;
  static const DefTable t =
      TableOf<D>("a surface that follows the bones, each vertex by the bones near it at rest")
          .objects("tubes", &D::tubes, tube_table(), {0, 1000}, "skins around chains of bones")
          .vectors("vertices", &D::vertices, "m", any(), {0, 1'000'000},
                   "of a mesh, in the world when all coordinates are at rest and the root is at the origin")
          .integers("triangles", &D::triangles, at_least(0), {0, 6'000'000}, "three vertices each")
          .choice("method", &D::method, {"linear", "dual_quaternion"},
                  "blends matrices, which collapse where bones twist, or dual quaternions, which do not")
          .choice("source", &D::source, {"scene", "motion_file"},
                  "motion_file: mesh and weights of the motion's glTF file")
          .number("falloff", &D::falloff, "1", between(0.5, 64),
                  "power of the distance with which a bone's weight falls")
          .vector("color", &D::color, "1", between(0, 1), "linear red, green, blue")
          .check([](const D& d, const DefTable::Report& report) {
            const bool from_file = d.source == SkinDef::Source::motion_file;
            if (d.tubes.empty() && d.vertices.empty() && !from_file)
              report("", "a skin needs tubes, vertices or the motion's file");
            if (from_file && !d.vertices.empty())
              report("/vertices", "the skin comes from the motion's file");
            if (d.triangles.size() % 3 != 0) report("/triangles", "three vertices per triangle");
            for (size_t i = 0; i < d.triangles.size(); ++i) {
              if (static_cast<size_t>(d.triangles[i]) < d.vertices.size()) continue;
              return report("/triangles/" + std::to_string(i), "there is no such vertex");
            }
          })
          .build();
  return t;
}

void check(const SkeletonDef& d, const DefTable::Report& report) {
  using animation::IkMethod;
  if (d.joints.empty() && !d.motion)
    report("/joints", "a skeleton needs joints, its own or those of a motion file");
  const bool squares = d.solver == IkMethod::gradient || d.solver == IkMethod::gauss_newton ||
                       d.solver == IkMethod::damped_least_squares;
  for (size_t k = 0; k < d.goals.size(); ++k) {
    const std::string at = "/goals/" + std::to_string(k);
    if (!d.goals[k].orientation.empty() && !squares) {
      report(at + "/orientation", "orientations need gradient, gauss_newton or damped_least_squares");
    }
    if (d.goals[k].priority > 0 && (!squares || d.solver == IkMethod::gradient)) {
      report(at + "/priority", "priorities need gauss_newton or damped_least_squares");
    }
  }
  if (d.prior && d.goals.empty())
    report("/prior", "a prior selects among the poses that reach goals: give goals");
  if (d.prior && !squares) report("/prior", "a prior needs gradient, gauss_newton or damped_least_squares");
  if (d.skin && d.skin->source == SkinDef::Source::motion_file &&
      (!d.motion || d.motion->gltf.empty() || !d.joints.empty()))
    report("/skin/source", "needs joints and motion from a glTF file");
  if (d.motion && d.motion->markers && d.joints.empty())
    report("/joints", "markers are fitted to the scene's joints: give joints");
  if (d.publish == SkeletonDef::Publish::skin && !d.skin) report("/publish", "there is no skin to publish");
}

}  // namespace

namespace {

DefTable table_for(const char* sentence, void (*needs)(const SkeletonDef&, const DefTable::Report&)) {
  using D = SkeletonDef;
  TableOf<D> table(sentence);
  table.objects("joints", &D::joints, joint_table(), {0, kMostJoints}, "parents first")
      .texts("root_position", &D::root_position, {0, 3}, "x, y and z (m) as expressions; a missing one is 0")
      .texts("root_rotation", &D::root_rotation, {0, 3}, "angles (rad) about x, y and z as expressions")
      .choice("root_order", &D::root_order, animation::kEulerOrders, "of the root's angles")
      .objects("goals", &D::goals, goal_table(), {0, 256}, "targets of inverse kinematics")
      .choice("solver", &D::solver,
              {"gradient", "gauss_newton", "damped_least_squares", "ccd", "fabrik", "two_link"},
              "method of inverse kinematics")
      .number("tolerance", &D::tolerance, "m", above(0), "distance at which a goal is reached")
      .integer("max_iterations", &D::max_iterations, between(1, 1'000'000), "of the solver per step")
      .choice("elbow", &D::elbow, {"positive", "negative"},
              "of two_link without a pole: side to which a revolute middle joint bends")
      .object("motion", &D::motion, motion_table(), "recorded motion")
      .objects("layers", &D::layers, layer_table(), {0, 64},
               "further recorded motions, blended in their order")
      .object("prior", &D::prior, prior_table(), "which of the poses that reach the goals is preferred")
      .object("skin", &D::skin, skin_table(), "a surface around the bones")
      .number("bone_radius", &D::bone_radius, "m", above(0), "of bones, which are capsules")
      .choice("publish", &D::publish, {"bones", "skin"}, "surface that others collide with")
      .vector("color", &D::color, "1", between(0, 1), "linear red, green, blue of the bones");
  animation::add_driver_rows(table);
  return table
      .check([needs](const D& d, const DefTable::Report& report) {
        check(d, report);
        if (needs) needs(d, report);
      })
      .build();
}

}  // namespace

const DefTable& skeleton_table() {
  static const DefTable t =
      table_for("a tree of joints that moves by expressions, keys, a motion file or towards goals", nullptr);
  return t;
}

const DefTable& ik_table() {
  static const DefTable t = table_for("a skeleton whose points reach for goals",
                                      [](const SkeletonDef& d, const DefTable::Report& report) {
                                        if (d.goals.empty())
                                          report("/goals", "inverse kinematics needs goals");
                                      });
  return t;
}

const DefTable& motion_capture_table() {
  static const DefTable t = table_for("a skeleton that moves as a motion file or markers say",
                                      [](const SkeletonDef& d, const DefTable::Report& report) {
                                        if (!d.motion)
                                          report("/motion", "motion capture needs a recorded motion");
                                      });
  return t;
}

Cost skeleton_cost(const void* def) {
  const auto& d = *static_cast<const SkeletonDef*>(def);
  double joints = static_cast<double>(d.joints.size()), text = 0;
  const auto letters = [](const MotionDef& m) {
    double sum = 0;
    for (const auto* lines : {&m.bvh, &m.gltf}) {
      for (const std::string& line : *lines) sum += static_cast<double>(line.size());
    }
    if (!m.markers) return sum;
    for (const auto* lines : {&m.markers->trc, &m.markers->images}) {
      for (const std::string& line : *lines) sum += static_cast<double>(line.size());
    }
    return sum;
  };
  if (d.motion) {
    text += letters(*d.motion);
    // A joint takes some hundred characters of a file, a number eight.
    if (d.joints.empty() && !d.motion->bvh.empty())
      joints = std::min(static_cast<double>(d.motion->bvh.size()) / 4, text / 80);
    if (d.joints.empty() && !d.motion->gltf.empty()) joints = std::min(text / 400, 200.0);
  }
  for (const LayerDef& l : d.layers) text += letters(l.motion);
  double prior = 0;
  if (d.prior) text += letters(d.prior->motion), prior = 1;
  double vertices = 0;
  if (d.skin) {
    vertices = static_cast<double>(d.skin->vertices.size());
    for (const TubeDef& t : d.skin->tubes) vertices += static_cast<double>(t.rings) * t.around + 2;
  }
  double keys = 0;
  for (const auto& c : d.controls) keys += static_cast<double>(c.times.size());
  const auto controls = static_cast<double>(d.controls.size()), goals = static_cast<double>(d.goals.size());
  return {.state_bytes = joints * (116 + 144) + 56 * vertices + 8 * controls + 600,
          .workspace_bytes = 8192 + 1400 * joints + 200 * vertices + 32 * keys + 400 * controls + 1.2 * text +
                             goals * joints * 300,
          .elements = joints + vertices + goals,
          .seconds_per_step = 2e-6 + 4e-7 * joints + 2e-8 * vertices + goals * 2e-5 + 1e-6 * joints * goals +
                              prior * goals * 1e-6 * joints};
}

}  // namespace truestep::skeleton
