#include "engine/systems/rigid3d/rigid3d_def.h"

#include <algorithm>
#include <cmath>

namespace truestep::rigid3d {
namespace {

constexpr double kMostBodies = 200'000;

const DefTable& copies_table() {
  static const DefTable t =
      TableOf<CopiesDef>("many bodies from one, arranged about its position")
          .choice("layout", &CopiesDef::layout, {"grid", "wall", "pyramid", "circle"},
                  "grid: count along x, y, z; wall: count[0] in the lowest row, one less in each row above; "
                  "pyramid: the same in both directions; circle: count[0] on a circle about y")
          .integers("count", &CopiesDef::count, between(1, kMostBodies), {1, 3},
                    "number of bodies along x, y, z")
          .vector("spacing", &CopiesDef::spacing, "m", any(), "distance between neighbours along x, y, z")
          .number("radius", &CopiesDef::radius, "m", above(0), "of the circle")
          .number("jitter", &CopiesDef::jitter, "m", at_least(0),
                  "maximum random displacement, from the scene's seed")
          .choice("turn", &CopiesDef::turn, {"none", "random", "outward"},
                  "orientation of the copies: that of the body, random, or that of the body rotated along "
                  "the circle")
          .build();
  return t;
}

/// Rows common to bodies of all shapes.
/// What all bodies have in common.
const DefTable& common_table() {
  static const DefTable t =
      TableOf<BodyDef>("a body")
          .text("id", &BodyDef::id, "name for commands, expectations and pictures")
          .choice("motion", &BodyDef::motion, {"dynamic", "fixed", "kinematic"},
                  "moved by forces, not at all, or only by its own velocity")
          .vector("position", &BodyDef::position, "m", any(), "of the shape's origin")
          .vector("axis", &BodyDef::axis, "1", any(), "axis of its rotation; any length")
          .number("angle", &BodyDef::angle, "rad", any(), "angle of its rotation")
          .numbers("orientation", &BodyDef::orientation, "1", any(), {0, 4},
                   "unit quaternion w x y z, instead of axis and angle")
          .vector("velocity", &BodyDef::velocity, "m/s", any(), "of the centre of mass")
          .vector("angular_velocity", &BodyDef::angular_velocity, "rad/s", any(), "in the world")
          .number("density", &BodyDef::density, "kg/m^3", above(0), "uniform")
          .number("mass", &BodyDef::mass, "kg", above(0),
                  "instead of density; scales the shape's inertia too")
          .numbers(
              "inertia", &BodyDef::inertia, "kg m^2", any(), {0, 6},
              "about the centre of mass, instead of that of the shape: xx yy zz or xx yy zz xy xz yz in its "
              "axes; principal moments above 0, none above the sum of the other two")
          .vector("force", &BodyDef::force, "N", any(),
                  "constant, at the centre of mass; keeps the body awake")
          .vector("torque", &BodyDef::torque, "N m", any(), "constant; keeps the body awake")
          .choice("force_frame", &BodyDef::force_frame, {"world", "body"},
                  "axes of force and torque: fixed, or turning with the shape. energy.potential includes a "
                  "force in the world; power.applied is the power of the others")
          .number("linear_damping", &BodyDef::linear_damping, "1/s", at_least(0),
                  "rate at which its velocity decays")
          .number("angular_damping", &BodyDef::angular_damping, "1/s", at_least(0),
                  "rate at which its angular velocity decays")
          .number("gravity_scale", &BodyDef::gravity_scale, "1", any(),
                  "factor on the gravity that acts on it")
          .number("friction", &BodyDef::friction, "1", at_least(0),
                  "Coulomb coefficient; of a contact: the square root of the product for both bodies")
          .number("restitution", &BodyDef::restitution, "1", between(0, 1),
                  "fraction of the normal speed kept; of a contact: the larger of both values")
          .number("rolling_resistance", &BodyDef::rolling_resistance, "m", at_least(0),
                  "torque against rolling per normal force; of a contact: the larger of both values")
          .number(
              "spinning_resistance", &BodyDef::spinning_resistance, "m", at_least(0),
              "torque against spinning on the spot per normal force; absent: from friction under a patch of "
              "a hundredth of a ball's or capsule's radius; of a contact: the larger of both values")
          .vector(
              "surface_velocity", &BodyDef::surface_velocity, "m/s", any(),
              "of its surface relative to its material, in its axes, like a belt's: friction carries along "
              "what touches it, by the component in the plane of contact")
          .integer(
              "group", &BodyDef::group, between(-32768, 32767),
              "bodies of the same group above 0 always touch, below 0 never; 0: category and mask decide")
          .integer("category", &BodyDef::category, between(0, 0xffffffff),
                   "bits for the categories that it belongs to")
          .integer("mask", &BodyDef::mask, between(0, 0xffffffff),
                   "bits for the categories that it collides with")
          .boolean("fixed_rotation", &BodyDef::fixed_rotation, "never rotates")
          .boolean("sensor", &BodyDef::sensor, "detects overlaps, collides with nothing")
          .boolean("asleep", &BodyDef::asleep, "sleeps until something touches it")
          .boolean("can_sleep", &BodyDef::can_sleep, "may fall asleep")
          .vector("one_way", &BodyDef::one_way, "1", any(),
                  "bodies that move along this direction (in the body's frame) pass, those that move "
                  "against it are held: up makes a platform to jump through")
          .vector("color", &BodyDef::color, "1", between(0, 1), "red, green, blue")
          .object("copies", &BodyDef::copies, copies_table(), "many bodies like this one")
          .build();
  return t;
}

void check_inertia(const std::vector<double>& I, const DefTable::Report& report) {
  if (I.empty()) return;
  if (I.size() != 3 && I.size() != 6) return report("/inertia", "must be xx yy zz or xx yy zz xy xz yz");
  const Symmetric3 inertia = inertia_of(I);
  const Vec3 m = principal_axes(inertia).moments;
  if (const auto fault = inertia_fault(inertia)) {
    report("/inertia", *fault);
  } else if (!(std::min({m.x, m.y, m.z}) > 1e-9 * std::max({m.x, m.y, m.z}))) {
    report("/inertia", "every principal moment must be above 0");
  }
}

/// `surface`: a shape without mass.
void check_body(const BodyDef& d, bool surface, const DefTable::Report& report) {
  if (!d.orientation.empty() && d.orientation.size() != 4)
    report("/orientation", "must have four numbers w x y z");
  if (d.orientation.size() == 4) {
    double n = 0;
    for (const double x : d.orientation) n += x * x;
    if (!(std::abs(n - 1) < 1e-6)) report("/orientation", "must have length 1");
  }
  if (d.motion != BodyDef::Motion::dynamic) {
    if (!d.inertia.empty()) report("/inertia", "only a dynamic body has an inertia");
    if (norm2(d.force) > 0) report("/force", "only a dynamic body is moved by forces");
    if (norm2(d.torque) > 0) report("/torque", "only a dynamic body is moved by forces");
  }
  if (d.fixed_rotation && !d.inertia.empty()) {
    report("/inertia", "a body that never rotates has no inertia");
  }
  if (d.fixed_rotation && norm2(d.angular_velocity) > 0) {
    report("/angular_velocity", "a body that never rotates has no angular velocity");
  }
  if (d.one_way && !(norm(*d.one_way) > 0)) report("/one_way", "the direction must not be zero");
  check_inertia(d.inertia, report);
  if (d.angle != 0 && !(norm(d.axis) > 0)) report("/axis", "the axis must not be zero");
  if (body_count(d) > kMostBodies) report("/copies/count", "the copies are more than 200000 bodies");
  if (surface && d.motion == BodyDef::Motion::dynamic) {
    report("/motion", "this shape has no mass: it must be fixed");
  }
}

template <class D>
DefTable finish(TableOf<D>& t) {
  constexpr bool surface = std::is_same_v<D, PlaneBodyDef> || std::is_same_v<D, HeightFieldBodyDef>;
  return t.template base<BodyDef>(common_table())
      .check([](const D& d, const DefTable::Report& report) { check_body(d, surface, report); })
      .build();
}

const DefTable& sphere_table() {
  static const DefTable t = [] {
    TableOf<SphereBodyDef> t("ball");
    t.number("radius", &SphereBodyDef::radius, "m", above(0), "radius");
    return finish(t);
  }();
  return t;
}
const DefTable& box_table() {
  static const DefTable t = [] {
    TableOf<BoxBodyDef> t("box");
    t.vector("half_extents", &BoxBodyDef::half_extents, "m", above(0), "half of each edge");
    return finish(t);
  }();
  return t;
}
const DefTable& capsule_table() {
  static const DefTable t = [] {
    TableOf<CapsuleBodyDef> t("cylinder with round ends along y");
    t.number("radius", &CapsuleBodyDef::radius, "m", above(0), "radius of the cylinder and of its ends")
        .number("half_length", &CapsuleBodyDef::half_length, "m", above(0),
                "half of the length without the ends");
    return finish(t);
  }();
  return t;
}
const DefTable& cylinder_table() {
  static const DefTable t = [] {
    TableOf<CylinderBodyDef> t("cylinder along y");
    t.number("radius", &CylinderBodyDef::radius, "m", above(0), "radius")
        .number("half_length", &CylinderBodyDef::half_length, "m", above(0), "half of its length");
    return finish(t);
  }();
  return t;
}
const DefTable& hull_table() {
  static const DefTable t = [] {
    TableOf<HullBodyDef> t("convex hull of points");
    t.vectors("points", &HullBodyDef::points, "m", any(), {4, 10'000}, "points in the body's frame");
    return finish(t);
  }();
  return t;
}
const DefTable& mesh_table() {
  static const DefTable t = [] {
    TableOf<MeshBodyDef> t("triangles, anticlockwise seen from outside; dynamic only if closed");
    t.vectors("vertices", &MeshBodyDef::vertices, "m", any(), {3, 1'000'000}, "corners")
        .integers("triangles", &MeshBodyDef::triangles, at_least(0), {3, 3'000'000}, "three indices each");
    return finish(t);
  }();
  return t;
}
const DefTable& height_field_table() {
  static const DefTable t = [] {
    TableOf<HeightFieldBodyDef> t("heights along y on a grid; fixed");
    t.integers("count", &HeightFieldBodyDef::count, between(2, 4096), {2, 2}, "points along x and z")
        .number("spacing", &HeightFieldBodyDef::spacing, "m", above(0), "from point to point")
        .numbers("heights", &HeightFieldBodyDef::heights, "m", any(), {4, 10'000'000},
                 "count[0] x count[1], x fastest");
    return finish(t);
  }();
  return t;
}
const DefTable& plane_table() {
  static const DefTable t = [] {
    TableOf<PlaneBodyDef> t("half space; fixed");
    t.vector("normal", &PlaneBodyDef::normal, "1", any(), "pointing to the free side; any length");
    return finish(t);
  }();
  return t;
}

const DefTable& part_table() {
  static const DefTable t =
      TableOf<PartDef>("a convex part")
          .vector("position", &PartDef::position, "m", any(), "in the body's frame")
          .vector("axis", &PartDef::axis, "1", any(), "axis of its rotation; any length")
          .number("angle", &PartDef::angle, "rad", any(), "angle of its rotation")
          .build();
  return t;
}
template <class D>
DefTable finish_part(TableOf<D>& t) {
  return t.template base<PartDef>(part_table()).build();
}
const DefTable& sphere_part_table() {
  static const DefTable t = [] {
    TableOf<SpherePartDef> t("ball");
    t.number("radius", &SpherePartDef::radius, "m", above(0), "radius");
    return finish_part(t);
  }();
  return t;
}
const DefTable& box_part_table() {
  static const DefTable t = [] {
    TableOf<BoxPartDef> t("box");
    t.vector("half_extents", &BoxPartDef::half_extents, "m", above(0), "half of each edge");
    return finish_part(t);
  }();
  return t;
}
const DefTable& capsule_part_table() {
  static const DefTable t = [] {
    TableOf<CapsulePartDef> t("cylinder with round ends along y");
    t.number("radius", &CapsulePartDef::radius, "m", above(0), "radius")
        .number("half_length", &CapsulePartDef::half_length, "m", above(0),
                "half of the length without the ends");
    return finish_part(t);
  }();
  return t;
}
const DefTable& cylinder_part_table() {
  static const DefTable t = [] {
    TableOf<CylinderPartDef> t("cylinder along y");
    t.number("radius", &CylinderPartDef::radius, "m", above(0), "radius")
        .number("half_length", &CylinderPartDef::half_length, "m", above(0), "half of its length");
    return finish_part(t);
  }();
  return t;
}
const DefTable& hull_part_table() {
  static const DefTable t = [] {
    TableOf<HullPartDef> t("convex hull of points");
    t.vectors("points", &HullPartDef::points, "m", any(), {4, 10'000}, "points in the part's frame");
    return finish_part(t);
  }();
  return t;
}
const DefTable& compound_table() {
  static const DefTable t = [] {
    TableOf<CompoundBodyDef> t("convex parts that move as one");
    t.variants("parts", &CompoundBodyDef::parts,
               {{"sphere", &sphere_part_table()},
                {"box", &box_part_table()},
                {"capsule", &capsule_part_table()},
                {"cylinder", &cylinder_part_table()},
                {"hull", &hull_part_table()}},
               {1, 10'000}, "the parts");
    return finish(t);
  }();
  return t;
}

}  // namespace

double body_count(const BodyDef& d) {
  if (!d.copies) return 1;
  const auto& c = d.copies->count;
  const auto n = [&c](size_t k) { return k < c.size() ? static_cast<double>(c[k]) : 1.0; };
  switch (d.copies->layout) {
    case CopiesDef::Layout::wall:
      return n(0) * (n(0) + 1) / 2;
    case CopiesDef::Layout::pyramid:
      return n(0) * (n(0) + 1) * (2 * n(0) + 1) / 6;
    case CopiesDef::Layout::circle:
      return n(0);
    case CopiesDef::Layout::grid:
      break;
  }
  return n(0) * n(1) * n(2);
}

const DefTable& rigid3d_table() {
  using D = Rigid3dDef;
  static const DefTable kTable =
      TableOf<D>("rigid bodies that touch, slide, roll, bounce and stack")
          .variants("bodies", &D::bodies,
                    {{"sphere", &sphere_table()},
                     {"box", &box_table()},
                     {"capsule", &capsule_table()},
                     {"cylinder", &cylinder_table()},
                     {"hull", &hull_table()},
                     {"mesh", &mesh_table()},
                     {"height_field", &height_field_table()},
                     {"plane", &plane_table()},
                     {"compound", &compound_table()}},
                    {1, 200'000}, "the bodies, in the order of their rows")
          .variants("joints", &D::joints, joint_tables(), {0, 200'000}, "joints between bodies")
          .choice("engine", &D::engine, {"truestep", "bullet"},
                  "solver: this product's own, or Bullet 3.24 for comparison")
          .vector("gravity", &D::gravity, "m/s^2", any(), "instead of the scene's")
          .integer("substeps", &D::substeps, between(1, 64),
                   "substeps of the contact solver per step of the scene")
          .choice("precision", &D::precision, {"f32", "f64"},
                  "precision of the contact solver; poses are always f64")
          .number("friction", &D::friction, "1", at_least(0), "default for bodies")
          .number("restitution", &D::restitution, "1", between(0, 1), "default for bodies")
          .number("restitution_speed", &D::restitution_speed, "m/s", at_least(0),
                  "slower impacts do not bounce; absent: half of the speed that gravity adds in a step (hops "
                  "of one step)")
          .also("rest_speed")
          .number("rolling_resistance", &D::rolling_resistance, "m", at_least(0), "default for bodies")
          .number("spinning_resistance", &D::spinning_resistance, "m", at_least(0),
                  "default for bodies; 0: balls spin for ever")
          .number("contact_hertz", &D::contact_hertz, "Hz", above(0),
                  "frequency of contacts as springs; absent: 0.13 of the rate of substeps")
          .number("contact_damping_ratio", &D::contact_damping_ratio, "1", above(0),
                  "damping ratio of soft contacts")
          .also("contact_damping")
          .number("push_out_speed", &D::push_out_speed, "m/s", above(0),
                  "maximum speed at which overlapping bodies are separated")
          .boolean("sleeping", &D::sleeping, "bodies at rest are not computed until something touches them")
          .number("sleep_speed", &D::sleep_speed, "m/s", above(0),
                  "bodies whose points are slower may rest if they also stay within 0.4 of this times "
                  "sleep_time (an eighth if held by joints or contacts without friction), which bounds "
                  "their mean speed; those that touch nothing and hang on joints rest only in balance: at "
                  "a mean speed of an eightieth of this and an acceleration of a thousandth of it per "
                  "sleep_time")
          .number("sleep_time", &D::sleep_time, "s", at_least(0),
                  "time at rest before sleep; freely floating bodies do not sleep")
          .check([](const D& d, const DefTable::Report& report) {
            double n = 0;
            for (const AnyBodyDef& b : d.bodies) n += body_count(common(b));
            if (n > kMostBodies) report("/bodies", "the system has more than 200000 bodies");
            double joints = 0;
            for (const AnyJointDef& j : d.joints) joints += static_cast<double>(joint_count(j));
            if (joints > kMostJoints) report("/joints", "the system has more than a million joints");
          })
          .build();
  return kTable;
}

}  // namespace truestep::rigid3d
