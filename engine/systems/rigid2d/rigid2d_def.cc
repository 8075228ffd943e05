#include "engine/systems/rigid2d/rigid2d_def.h"

#include <set>

#include "engine/systems/rigid2d/joint_tables.h"

namespace truestep::rigid2d {
namespace {

constexpr int64_t kMostPerSide = 2000;

const DefTable& circle_table() {
  using D = CircleDef;
  static const DefTable t = TableOf<D>("a disk")
                                .number("radius", &D::radius, "m", above(0), "radius")
                                .vector("center", &D::center, "m", any(), "in the body's frame")
                                .build();
  return t;
}

const DefTable& capsule_table() {
  using D = CapsuleDef;
  static const DefTable t = TableOf<D>("all points within a radius of a segment")
                                .vector("from", &D::from, "m", any(), "one end, in the body's frame")
                                .vector("to", &D::to, "m", any(), "the other end")
                                .number("radius", &D::radius, "m", above(0), "radius")
                                .build();
  return t;
}

const DefTable& box_table() {
  using D = BoxDef;
  static const DefTable t =
      TableOf<D>("a rectangle")
          .vector("half_extents", &D::half_extents, "m", at_least(0), "half of each edge; z is not used")
          .vector("center", &D::center, "m", any(), "in the body's frame")
          .number("angle", &D::angle, "rad", any(), "rotation about its centre")
          .number("radius", &D::radius, "m", at_least(0), "rounding radius, added on all sides")
          .check([](const D& d, const DefTable::Report& report) {
            if (!(d.half_extents.x > 0 && d.half_extents.y > 0)) {
              report("/half_extents", "x and y must be above 0");
            }
          })
          .build();
  return t;
}

const DefTable& polygon_table() {
  using D = PolygonDef;
  static const DefTable t =
      TableOf<D>("the convex hull of points; at most eight corners")
          .vectors("points", &D::points, "m", any(), {3, 64}, "in the body's frame, in any order")
          .required()
          .number("radius", &D::radius, "m", at_least(0), "rounding radius, added on all sides")
          .build();
  return t;
}

const DefTable& chain_table() {
  using D = ChainDef;
  static const DefTable t =
      TableOf<D>("a line through points that bodies rest on and slide along without catching at its corners")
          .vectors("points", &D::points, "m", any(), {2, 100'000}, "corners, in the body's frame")
          .required()
          .boolean("loop", &D::loop, "joins the last point to the first")
          .choice(
              "sides", &D::sides, {"both", "left", "right", "outside", "inside"},
              "sides that bodies collide with: both, only the left or right one when following the points "
              "(left for ground drawn from left to right), or for a loop only the outside or inside; bodies "
              "on the other side pass, and those that are half through are pushed back")
          .check([](const D& d, const DefTable::Report& report) {
            const bool closed = d.sides == D::Sides::outside || d.sides == D::Sides::inside;
            if (closed && !d.loop) report("/sides", "only a loop has an outside and an inside");
          })
          .build();
  return t;
}

TableOf<BodyDef>& body_rows(TableOf<BodyDef>& t) {
  using D = BodyDef;
  return t
      .choice("motion", &D::motion, {"dynamic", "kinematic", "fixed"},
              "moved by forces, by its own velocity only, or not at all")
      .vector("position", &D::position, "m", any(), "origin of the body's frame; z is not used")
      .number("angle", &D::angle, "rad", any(), "counter-clockwise")
      .vector("velocity", &D::velocity, "m/s", any(), "of the centre of mass")
      .number("angular_velocity", &D::angular_velocity, "rad/s", any(), "counter-clockwise")
      .variants("shapes", &D::shapes,
                {{"circle", &circle_table()},
                 {"capsule", &capsule_table()},
                 {"box", &box_table()},
                 {"polygon", &polygon_table()},
                 {"chain", &chain_table()}},
                {0, 256}, "the shapes that form it; a chain is only for fixed or kinematic bodies")
      .number("density", &D::density, "kg/m^2", above(0), "of all its shapes")
      .number("mass", &D::mass, "kg", above(0), "instead of density; scales the inertia too")
      .number("inertia", &D::inertia, "kg m^2", above(0),
              "moment of inertia about the centre of mass, instead of that of the shapes")
      .vector("force", &D::force, "N", any(),
              "constant, at the centre of mass; z is not used. Keeps the body awake")
      .number("torque", &D::torque, "N m", any(), "constant, counter-clockwise")
      .choice("force_frame", &D::force_frame, {"world", "body"},
              "axes of force: fixed, or turning with the body. energy.potential includes torque and a "
              "force in the world; power.applied is the power of one that turns")
      .number("friction", &D::friction, "1", at_least(0),
              "of a contact: the square root of the product for both bodies")
      .number("restitution", &D::restitution, "1", between(0, 1), "of a contact: the larger of both values")
      .number("rolling_resistance", &D::rolling_resistance, "m", at_least(0),
              "torque against rolling per normal force; of a contact: the larger of both values")
      .number("surface_speed", &D::surface_speed, "m/s", any(),
              "speed at which its surface moves clockwise about it (the top of a belt to the right)")
      .number("linear_damping", &D::linear_damping, "1/s", at_least(0), "rate at which its velocity decays")
      .number("angular_damping", &D::angular_damping, "1/s", at_least(0),
              "rate at which its angular velocity decays")
      .number("gravity_scale", &D::gravity_scale, "1", any(), "factor on the gravity that acts on it")
      .boolean("fixed_rotation", &D::fixed_rotation, "never rotates")
      .boolean("sensor", &D::sensor, "detects overlaps, collides with nothing")
      .boolean("bullet", &D::bullet, "does not pass through moving bodies either, however fast it is")
      .boolean("asleep", &D::asleep, "sleeps until something touches it")
      .boolean("can_sleep", &D::can_sleep, "may fall asleep")
      .vector("one_way", &D::one_way, "1", any(),
              "bodies that move along this direction (in the body's frame) pass, those that move "
              "against it are held: up makes a platform to jump through")
      .vector("color", &D::color, "1", between(0, 1), "red, green, blue as a screen shows them")
      .integer("group", &D::group, between(-32768, 32767),
               "bodies of the same group above 0 always touch, below 0 never; 0: category and mask decide")
      .integer("category", &D::category, between(0, 4294967295.0),
               "bits for the categories that it belongs to")
      .integer("mask", &D::mask, between(0, 4294967295.0), "bits for the categories that it collides with");
}

const DefTable& body_table() {
  using D = BodyDef;
  static const DefTable t = [] {
    TableOf<D> table("a rigid body");
    table.text("id", &D::id, "name for commands");
    body_rows(table).check([](const D& d, const DefTable::Report& report) {
      bool chain = false;
      for (const ShapeDef& s : d.shapes) chain = chain || std::holds_alternative<ChainDef>(s);
      if (chain && d.motion == Motion::dynamic) {
        report("/shapes", "a chain has no mass: the body must be fixed or kinematic");
      }
      if (d.motion == Motion::dynamic && d.shapes.empty()) {
        report("/shapes", "a dynamic body needs a shape, which gives its mass");
      }
      if (d.motion != Motion::dynamic && d.inertia) report("/inertia", "only a dynamic body has an inertia");
      if (d.motion != Motion::dynamic && (norm2(d.force) > 0 || d.torque != 0)) {
        report(norm2(d.force) > 0 ? "/force" : "/torque", "only a dynamic body is moved by forces");
      }
      if (d.fixed_rotation && d.inertia) report("/inertia", "a body that never rotates has no inertia");
      if (d.fixed_rotation && d.angular_velocity != 0) {
        report("/angular_velocity", "a body that never rotates has no angular velocity");
      }
      if (d.one_way && !(d.one_way->x != 0 || d.one_way->y != 0)) {
        report("/one_way", "the direction must not be zero");
      }
    });
    return table.build();
  }();
  return t;
}

const DefTable& link_table() {
  static const DefTable t = [] {
    TableOf<BodyDef> table("a link of a chain of bodies");
    return body_rows(table).build();
  }();
  return t;
}

const DefTable& grid_table() {
  using D = GridDef;
  static const DefTable t =
      TableOf<D>(
          "bodies in rows and columns; number k * ny + i is in column k from the left and row i from below")
          .object("body", &D::body, body_table(), "the body to repeat; its position is not used")
          .vector("origin", &D::origin, "m", any(), "position of the first body")
          .vector("spacing", &D::spacing, "m", any(), "from one to the next; y may be negative")
          .integer("nx", &D::nx, between(1, kMostPerSide), "columns")
          .integer("ny", &D::ny, between(1, kMostPerSide), "rows")
          .boolean("joined", &D::joined, "revolute joints midway between neighbours")
          .integers("held", &D::held, between(0, kMostBodies), {0, 100'000},
                    "numbers of the bodies that are fixed")
          .build();
  return t;
}

const DefTable& pyramid_table() {
  using D = PyramidDef;
  static const DefTable t =
      TableOf<D>("rows of bodies, each one body shorter than the row below")
          .object("body", &D::body, body_table(), "the body to repeat; its position is not used")
          .vector("origin", &D::origin, "m", any(), "middle of the lowest row")
          .vector("spacing", &D::spacing, "m", at_least(0), "along a row and from row to row")
          .integer("base", &D::base, between(1, 1000), "bodies in the lowest row")
          .build();
  return t;
}

const DefTable& wall_table() {
  using D = WallDef;
  static const DefTable t =
      TableOf<D>("rows of bodies, every other row half a spacing to the right")
          .object("body", &D::body, body_table(), "the body to repeat; its position is not used")
          .vector("origin", &D::origin, "m", any(), "position of the first body")
          .vector("spacing", &D::spacing, "m", at_least(0), "along a row and from row to row")
          .integer("nx", &D::nx, between(1, kMostPerSide), "bodies in a row")
          .integer("ny", &D::ny, between(1, kMostPerSide), "rows")
          .build();
  return t;
}

const DefTable& body_chain_table() {
  using D = BodyChainDef;
  static const DefTable t =
      TableOf<D>("capsules joined end to end by revolute joints")
          .object("body", &D::body, link_table(), "the body to repeat; its position and shapes are not used")
          .vector("from", &D::from, "m", any(), "one end")
          .vector("to", &D::to, "m", any(), "the other end")
          .integer("links", &D::links, between(1, 100'000), "number of capsules")
          .number("radius", &D::radius, "m", above(0), "of the capsules")
          .choice("held", &D::held, {"none", "first", "both"}, "which ends are hinged to the world")
          .build();
  return t;
}

double shapes_of(const BodyDef& b) {
  double n = 0;
  for (const ShapeDef& s : b.shapes) {
    const auto* c = std::get_if<ChainDef>(&s);
    n += c ? static_cast<double>(c->points.size()) : 1;
  }
  return n;
}

struct CountGenerated {
  Counts operator()(const GridDef& d) const {
    const double n = static_cast<double>(d.nx) * static_cast<double>(d.ny);
    const double shapes = n * shapes_of(d.body);
    return {n, shapes, d.joined ? 2 * n : 0, shapes};
  }
  Counts operator()(const PyramidDef& d) const {
    const auto b = static_cast<double>(d.base);
    const double n = b * (b + 1) / 2, shapes = n * shapes_of(d.body);
    return {n, shapes, 0, shapes};
  }
  Counts operator()(const WallDef& d) const {
    const double n = static_cast<double>(d.nx) * static_cast<double>(d.ny);
    const double shapes = n * shapes_of(d.body);
    return {n, shapes, 0, shapes};
  }
  Counts operator()(const BodyChainDef& d) const {
    const auto n = static_cast<double>(d.links);
    return {n, n, n + 1, n};
  }
};

void check(const Rigid2dDef& d, const DefTable::Report& report) {
  const double n = counts(d).bodies;
  if (n > kMostBodies) report("/generators", "the system has more than a million bodies");
  if (n == 0) report("", "no bodies and no generators: nothing to simulate");
  for (size_t i = 0; i < d.generators.size(); ++i) {
    const auto& body = std::visit([](const auto& g) -> const BodyDef& { return g.body; }, d.generators[i]);
    if (!body.id.empty())
      report("/generators/" + std::to_string(i) + "/body/id",
             "an id is of one body: only listed bodies have one");
  }
  std::set<std::string> ids;
  for (size_t i = 0; i < d.joints.size(); ++i) {
    const std::string at = "/joints/" + std::to_string(i);
    const auto& j = std::visit([](const auto& x) -> const JointDef& { return x; }, d.joints[i]);
    if (!j.id.empty() && !ids.insert(j.id).second) report(at + "/id", "another joint has this id");
    if (static_cast<double>(j.a) >= n) report(at + "/a", "there is no such body");
    if (static_cast<double>(j.b) >= n) report(at + "/b", "there is no such body");
    if (j.a == j.b) report(at + "/b", "a joint needs two different bodies");
  }
}

}  // namespace

Counts counts(const Rigid2dDef& def) {
  Counts total;
  for (const BodyDef& b : def.bodies) {
    total.bodies += 1, total.shapes += shapes_of(b);
    if (b.motion == Motion::dynamic) total.moving_shapes += shapes_of(b);
  }
  for (const GeneratorDef& g : def.generators) {
    const Counts c = std::visit(CountGenerated{}, g);
    total.bodies += c.bodies, total.shapes += c.shapes, total.joints += c.joints;
    total.moving_shapes += c.moving_shapes;
  }
  total.joints += static_cast<double>(def.joints.size());
  return total;
}

const DefTable& rigid2d_table() {
  using D = Rigid2dDef;
  static const DefTable t =
      TableOf<D>("rigid bodies in the plane x, y with contacts, friction and joints")
          .objects("bodies", &D::bodies, body_table(), {0, 1'000'000}, "bodies, numbered from 0")
          .variants("generators", &D::generators,
                    {{"grid", &grid_table()},
                     {"pyramid", &pyramid_table()},
                     {"wall", &wall_table()},
                     {"chain", &body_chain_table()}},
                    {0, 10'000}, "patterns of many bodies, numbered after the listed ones")
          .variants("joints", &D::joints,
                    {{"revolute|hinge|pin", &revolute_table()},
                     {"prismatic|slider", &prismatic_table()},
                     {"distance", &distance_table()},
                     {"spring", &spring_table()},
                     {"fixed|weld", &weld_table()},
                     {"wheel", &wheel_table()},
                     {"motor", &motor_table()},
                     {"mouse", &mouse_table()},
                     {"gear", &gear_table()},
                     {"pulley", &pulley_table()}},
                    {0, 1'000'000}, "joints between bodies")
          .choice("engine", &D::engine, {"truestep", "box2d"},
                  "solver: this product's own, or Box2D 2.4.1 for comparison")
          .vector("gravity", &D::gravity, "m/s^2", any(), "absent: the scene's")
          .integer("substeps", &D::substeps, between(1, 1000),
                   "substeps of the constraint solver per step of the scene")
          .also("solver_steps")
          .choice("precision", &D::precision, {"f32", "f64"},
                  "precision of the constraint solver; poses are always f64")
          .number(
              "contact_hertz", &D::contact_hertz, "Hz", above(0),
              "frequency of contacts as springs for a body with two, lower for one with more; absent: 0.21 "
              "of the rate of substeps")
          .number("contact_damping_ratio", &D::contact_damping_ratio, "1", at_least(0),
                  "damping ratio of contacts")
          .number("joint_hertz", &D::joint_hertz, "Hz", above(0),
                  "natural frequency of joints; absent: a quarter of the rate of substeps")
          .number("joint_damping_ratio", &D::joint_damping_ratio, "1", at_least(0), "damping ratio of joints")
          .number("push_out_speed", &D::push_out_speed, "m/s", above(0),
                  "maximum speed at which overlapping bodies are separated")
          .also("push_speed")
          .number("contact_margin", &D::contact_margin, "m", above(0),
                  "distance at which contacts begin; absent: from the bodies' size")
          .number("friction", &D::friction, "1", at_least(0), "default for bodies")
          .number("restitution", &D::restitution, "1", between(0, 1), "default for bodies")
          .number("rolling_resistance", &D::rolling_resistance, "m", at_least(0), "default for bodies")
          .number("restitution_speed", &D::restitution_speed, "m/s", at_least(0),
                  "slower impacts do not bounce; absent: half of the speed that gravity adds in a step (hops "
                  "of one step)")
          .boolean("sleeping", &D::sleeping, "bodies at rest are not computed until something touches them")
          .number("sleep_speed", &D::sleep_speed, "m/s", at_least(0),
                  "bodies whose points are slower may rest if they also stay within 0.4 of this times "
                  "sleep_time (an eighth if held by joints or contacts without friction), which bounds "
                  "their mean speed; those that touch nothing and hang on joints rest only in balance: at "
                  "a mean speed of an eightieth of this and an acceleration of a thousandth of it per "
                  "sleep_time")
          .number("sleep_time", &D::sleep_time, "s", at_least(0),
                  "time at rest before sleep; freely floating bodies do not sleep")
          .vector("color", &D::color, "1", between(0, 1),
                  "red, green, blue of all moving bodies, as a screen shows them")
          .check(check)
          .build();
  return t;
}

}  // namespace truestep::rigid2d
