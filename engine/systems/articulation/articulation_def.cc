#include "engine/systems/articulation/articulation_def.h"

#include <cmath>
#include <set>

#include "engine/geometry/mass_properties.h"

namespace truestep::articulation {
namespace {

constexpr double kMostLinks = 100'000;

template <class D>
DefTable finish(TableOf<D>& t) {
  Vec3 D::*position = &LinkShapeDef::position;
  Vec3 D::*rotation = &LinkShapeDef::rotation;
  return t.vector("position", position, "m", any(), "in the link's frame")
      .vector("rotation", rotation, "rad", any(), "rotation of its own, as a rotation vector")
      .build();
}
const DefTable& sphere_table() {
  static const DefTable t = [] {
    TableOf<SphereLinkDef> t("ball");
    t.number("radius", &SphereLinkDef::radius, "m", above(0), "radius");
    return finish(t);
  }();
  return t;
}
const DefTable& box_table() {
  static const DefTable t = [] {
    TableOf<BoxLinkDef> t("box");
    t.vector("half_extents", &BoxLinkDef::half_extents, "m", above(0), "half of each edge");
    return finish(t);
  }();
  return t;
}
const DefTable& capsule_table() {
  static const DefTable t = [] {
    TableOf<CapsuleLinkDef> t("cylinder along y with round ends");
    t.number("radius", &CapsuleLinkDef::radius, "m", above(0), "of the cylinder and its ends")
        .number("half_length", &CapsuleLinkDef::half_length, "m", above(0),
                "half of the cylinder without its ends");
    return finish(t);
  }();
  return t;
}
const DefTable& cylinder_table() {
  static const DefTable t = [] {
    TableOf<CylinderLinkDef> t("cylinder along y");
    t.number("radius", &CylinderLinkDef::radius, "m", above(0), "radius")
        .number("half_length", &CylinderLinkDef::half_length, "m", above(0), "half of its length");
    return finish(t);
  }();
  return t;
}

const DefTable& copies_table() {
  static const DefTable t =
      TableOf<LinkCopiesDef>("a chain: more links like this one, each attached to the one before")
          .integer("count", &LinkCopiesDef::count, between(1, kMostLinks), "links in all")
          .vector("offset", &LinkCopiesDef::offset, "m", any(),
                  "position of each further link's joint in the frame of the one before")
          .build();
  return t;
}

void check_link(const LinkDef& d, const DefTable::Report& report) {
  const size_t nq = joint_positions(d.joint), nv = joint_velocities(d.joint);
  if (!d.q.empty() && d.q.size() != nq) report("/q", "this joint has " + std::to_string(nq) + " coordinates");
  if (!d.v.empty() && d.v.size() != nv) report("/v", "this joint has " + std::to_string(nv) + " velocities");
  if (!d.torque.empty() && d.torque.size() != nv) {
    report("/torque", "this joint takes " + std::to_string(nv) + " torques or forces");
  }
  if (d.joint == JointType::spherical || d.joint == JointType::free) {
    double n = 0;
    for (size_t k = nq - 4; k < d.q.size(); ++k) n += d.q[k] * d.q[k];
    if (d.q.size() == nq && !(std::abs(n - 1) < 1e-6)) report("/q", "the quaternion must have length 1");
    if (d.joint == JointType::free && (d.lowest || d.highest))
      report(d.lowest ? "/lowest" : "/highest", "this joint has no limits");
  }
  if (d.cone && d.joint != JointType::spherical) report("/cone", "only spherical joints have a cone");
  if (d.joint == JointType::spherical) {
    constexpr double kHalfTurn = 3.141592653589793;
    if (d.lowest && !(std::abs(*d.lowest) <= kHalfTurn))
      report("/lowest", "a twist must be within half a turn");
    if (d.highest && !(std::abs(*d.highest) <= kHalfTurn))
      report("/highest", "a twist must be within half a turn");
  }
  if (!(norm(d.axis) > 0)) report("/axis", "the axis must not be zero");
  if (d.joint == JointType::universal && !(norm(cross(d.axis, d.second_axis)) > 1e-9)) {
    report("/second_axis", "must not be parallel to axis");
  }
  if (d.lowest && d.highest && !(*d.lowest < *d.highest)) report("/highest", "must be above lowest");
  if (!d.inertia.empty() && d.inertia.size() != 3 && d.inertia.size() != 6) {
    report("/inertia", "needs xx yy zz or xx yy zz xy xz yz");
  } else if (const auto& I = d.inertia; !I.empty()) {
    Symmetric3 inertia{I[0], I[1], I[2]};
    if (I.size() == 6) inertia.xy = I[3], inertia.xz = I[4], inertia.yz = I[5];
    if (const auto fault = inertia_fault(inertia)) report("/inertia", *fault);
  }
  if (!d.mass && (d.shapes.empty() || !d.inertia.empty())) {
    report("/mass", d.shapes.empty() ? "needs a mass or shapes" : "an inertia needs a mass");
  }
}

const DefTable& link_table() {
  static const DefTable t =
      TableOf<LinkDef>("a rigid body and its joint; its frame has its origin in the joint")
          .text("id", &LinkDef::id, "name for parents, commands and pictures")
          .text("parent", &LinkDef::parent,
                "id of an earlier link, or ground; absent: the link before, the ground for the first")
          .choice("joint", &LinkDef::joint,
                  {"revolute|hinge|pin", "prismatic|slider", "spherical|ball", "universal", "cylindrical",
                   "fixed|weld", "free"},
                  "revolute: turns about axis; prismatic: moves along axis; spherical; universal: about "
                  "axis, then "
                  "about second_axis; cylindrical: moves along and turns about axis; fixed; free: any motion")
          .vector("axis", &LinkDef::axis, "1", any(), "in the joint's frame; any length")
          .vector("second_axis", &LinkDef::second_axis, "1", any(), "of a universal joint")
          .vector("offset", &LinkDef::offset, "m", any(), "position of the joint in the parent's frame")
          .vector("rotation", &LinkDef::rotation, "rad", any(),
                  "rotation of the joint's frame in the parent's, as a rotation vector")
          .number("mass", &LinkDef::mass, "kg", above(0), "instead of density")
          .vector("center", &LinkDef::center, "m", any(), "centre of mass, if shapes do not give it")
          .numbers("inertia", &LinkDef::inertia, "kg m^2", any(), {0, 6},
                   "xx yy zz or xx yy zz xy xz yz about the centre (no principal moment above the sum of the "
                   "other two); shapes are then only drawn. Absent, without shapes: a point mass")
          .number("density", &LinkDef::density, "kg/m^3", above(0), "uniform, of the shapes")
          .variants("shapes", &LinkDef::shapes,
                    {{"sphere", &sphere_table()},
                     {"box", &box_table()},
                     {"capsule", &capsule_table()},
                     {"cylinder", &cylinder_table()}},
                    {0, 1000}, "give mass, centre and inertia unless inertia is given, and are drawn")
          .numbers(
              "q", &LinkDef::q, "", any(), {0, 7},
              "start: revolute rad; prismatic m; universal two rad; cylindrical m, rad; spherical quaternion "
              "w x y z; "
              "free x y z and quaternion")
          .numbers("v", &LinkDef::v, "", any(), {0, 6},
                   "start: one rate per coordinate; spherical: angular velocity in the link's frame; free: "
                   "velocity "
                   "in the joint's frame, angular velocity in the link's")
          .numbers("torque", &LinkDef::torque, "", any(), {0, 6},
                   "constant drive of the joint, N m or N, one per number of v")
          .number("damping", &LinkDef::damping, "", at_least(0),
                  "viscous, against the joint's velocity, N m s or N s/m")
          .number("stiffness", &LinkDef::stiffness, "", at_least(0),
                  "spring towards rest, N m or N/m; spherical: 2 k sin^2(angle / 2) towards no rotation")
          .number("rest", &LinkDef::rest, "", any(), "coordinate where the spring exerts nothing")
          .number("lowest", &LinkDef::lowest, "", any(),
                  "soft limit of the first coordinate; of a spherical joint of its twist about axis, rad")
          .number("highest", &LinkDef::highest, "", any(),
                  "soft limit of the first coordinate; of a spherical joint of its twist about axis, rad")
          .number("cone", &LinkDef::cone, "rad", between(0, 3.1),
                  "soft limit of how far axis swings in a spherical joint")
          .number("limit_stiffness", &LinkDef::limit_stiffness, "", above(0),
                  "spring beyond a limit, N m or N/m")
          .number("limit_damping", &LinkDef::limit_damping, "", at_least(0),
                  "damper beyond a limit; it never pulls back")
          .vector("force", &LinkDef::force, "N", any(), "constant, on the link's centre of mass")
          .vector("moment", &LinkDef::moment, "N m", any(), "constant torque on the link")
          .choice("force_frame", &LinkDef::force_frame, {"world", "link"},
                  "axes of force and moment: fixed, or turning with the link. A force in the world counts in "
                  "energy.potential, the others in power.applied")
          .object("copies", &LinkDef::copies, copies_table(), "makes a chain of it")
          .check(check_link)
          .build();
  return t;
}

const DefTable& closure_table() {
  static const DefTable t =
      TableOf<ClosureDef>("closes a loop: a point of one link stays at a point of another")
          .text("a", &ClosureDef::a, "id of a link; of copies the last")
          .required()
          .text("b", &ClosureDef::b, "id of another, or ground")
          .vector("point_a", &ClosureDef::point_a, "m", any(), "in the frame of a")
          .vector("point_b", &ClosureDef::point_b, "m", any(), "in the frame of b")
          .build();
  return t;
}

const DefTable& spring_table() {
  static const DefTable t =
      TableOf<LinkSpringDef>("spring and damper between points of two links")
          .text("a", &LinkSpringDef::a, "id of a link; of copies the last")
          .required()
          .text("b", &LinkSpringDef::b, "id of another, or ground")
          .vector("point_a", &LinkSpringDef::point_a, "m", any(), "in the frame of a")
          .vector("point_b", &LinkSpringDef::point_b, "m", any(), "in the frame of b")
          .number("stiffness", &LinkSpringDef::stiffness, "N/m", at_least(0), "force per length beyond rest")
          .number("damping", &LinkSpringDef::damping, "N s/m", at_least(0), "force per rate of length")
          .number("rest_length", &LinkSpringDef::rest_length, "m", at_least(0), "length without force")
          .build();
  return t;
}

/// Checks that the ends of closures and springs are existing links.
template <class D>
void check_ends(const std::vector<D>& all, const std::string& name, const std::set<std::string>& known,
                const DefTable::Report& report) {
  for (size_t i = 0; i < all.size(); ++i) {
    const std::string at = name + std::to_string(i);
    if (!known.contains(all[i].a)) report(at + "/a", "no link has the id " + all[i].a);
    if (!known.contains(all[i].b)) report(at + "/b", "no link has the id " + all[i].b);
    if (all[i].a == all[i].b) report(at + "/b", "must not be the same link as a");
  }
}

}  // namespace

const DefTable& articulation_table() {
  using D = ArticulationDef;
  static const DefTable kTable = [] {
    TableOf<D> t("rigid links in a tree of joints, in the joints' own coordinates; loops by closures");
    t.objects("links", &D::links, link_table(), {1, 100'000}, "parents before children")
        .objects("closures", &D::closures, closure_table(), {0, 200},
                 "loops, closed by constraint forces; the start is moved to where they close")
        .objects("springs", &D::springs, spring_table(), {0, 10'000}, "springs between links")
        .vector("gravity", &D::gravity, "m/s^2", any(), "instead of the scene's")
        .number("point_radius", &D::point_radius, "m", at_least(0),
                "of joints and centres in pictures; default 0.03, 0 where all links have shapes")
        .vector("color", &D::color, "1", between(0, 1), "red, green, blue");
    t.check([](const D& d, const DefTable::Report& report) {
      double n = 0;
      std::set<std::string> known{"ground"};
      for (size_t i = 0; i < d.links.size(); ++i) {
        const LinkDef& l = d.links[i];
        const std::string at = "/links/" + std::to_string(i);
        if (l.parent && !known.contains(*l.parent)) {
          report(at + "/parent", "no earlier link has the id " + *l.parent);
        }
        if (!l.id.empty() && !known.insert(l.id).second) report(at + "/id", "another link has this id");
        n += l.copies ? static_cast<double>(l.copies->count) : 1;
      }
      check_ends(d.closures, "/closures/", known, report);
      check_ends(d.springs, "/springs/", known, report);
      if (n > kMostLinks) report("/links", "more than 100000 links in all");
    });
    add_integrator_rows(t);
    return t.build();
  }();
  return kTable;
}

}  // namespace truestep::articulation
