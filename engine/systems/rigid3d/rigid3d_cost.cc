// Estimated cost of a scene of rigid bodies in space, from its description alone. Measured with gallery
// scenes: stacks, heaps, ragdolls, machines.
#include <algorithm>
#include <cmath>

#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::rigid3d {

namespace {

struct Numbers {
  double bodies = 0, moving = 0;
  double level = 0;                       // of dynamic bodies: as low as the lowest, which lie on the floor
  double heaped = 0;                      // in blocks of copies
  double layered = 0, layered_edges = 0;  // in layers that fall on each other; those that are not spheres
  double edged = 0;                       // of hulls and compounds, which have many faces
  double balls = 0, guided = 0, joints = 0;  // joints: spherical, with six driven rows, others
};

bool in_a_block(const BodyDef& b) {
  return b.copies && std::ranges::count_if(b.copies->count, [](int64_t k) { return k > 1; }) >= 2;
}

// Layers fall into a heap; a wall stands.
bool in_layers(const BodyDef& b) {
  return b.copies && b.copies->count.size() > 2 && b.copies->count[0] > 1 && b.copies->count[2] > 1;
}

bool piled(const BodyDef& b) {
  using Layout = CopiesDef::Layout;
  if (!b.copies || b.copies->layout == Layout::circle) return false;
  return b.copies->layout != Layout::grid || (b.copies->count.size() > 1 && b.copies->count[1] > 1);
}

Numbers count(const Rigid3dDef& d) {
  Numbers n;
  double floor = HUGE_VAL;
  for (const AnyBodyDef& any : d.bodies) {
    if (common(any).motion == BodyDef::Motion::dynamic) floor = std::min(floor, common(any).position.y);
  }
  for (const AnyBodyDef& any : d.bodies) {
    const BodyDef& b = common(any);
    const double bodies = body_count(b);
    n.bodies += bodies;
    if (b.motion != BodyDef::Motion::dynamic) continue;
    n.moving += bodies;
    if (!piled(b) && b.position.y <= floor + 1e-3) n.level += bodies;
    if (in_a_block(b)) n.heaped += bodies;
    if (in_layers(b)) n.layered += bodies;
    if (in_layers(b) && !std::holds_alternative<SphereBodyDef>(any)) n.layered_edges += bodies;
    if (std::holds_alternative<HullBodyDef>(any) || std::holds_alternative<CompoundBodyDef>(any))
      n.edged += bodies;
  }
  for (const AnyJointDef& j : d.joints) {
    const auto joints = static_cast<double>(joint_count(j));
    const bool guided =
        std::holds_alternative<SixDofJointDef>(j) || std::holds_alternative<ConeTwistJointDef>(j);
    (std::holds_alternative<BallJointDef>(j) ? n.balls : guided ? n.guided : n.joints) += joints;
  }
  return n;
}

double remembered_contacts(const Numbers& n) {
  const double joints = n.balls + n.guided + n.joints;
  return std::max(2.8 * (n.moving - joints), 1.5 * n.moving) + 1.3 * n.heaped;
}

double seconds(const Rigid3dDef& d, const Numbers& n) {
  // A body on the floor touches only the floor, one above touches several; jointed bodies touch little.
  const double free = std::max(n.moving - n.balls - n.guided - n.joints, 0.0) / std::max(n.moving, 1.0);
  const double contacts =
      std::max(free * (1.6 * n.level + 3.5 * (n.moving - n.level)), 0.5 * n.moving) + 1.3 * n.layered;
  const double steps = (d.precision == Rigid3dDef::Precision::f64 ? 2 : 1) * static_cast<double>(d.substeps);
  return 2e-7 * n.bodies + contacts * (5e-7 + 5e-8 * steps) + 2e-6 * n.layered + 1.6e-5 * n.layered_edges +
         1.5e-6 * free * n.edged + n.balls * (2e-7 + 2e-7 * steps) + n.joints * (3e-7 + 5.5e-7 * steps) +
         n.guided * (3e-7 + 2.2e-6 * steps);
}

}  // namespace

Cost rigid3d_cost(const void* def) {
  const auto& d = *static_cast<const Rigid3dDef*>(def);
  const Numbers n = count(d);
  const double contacts = remembered_contacts(n);
  // All joints except spherical ones have limits and drives.
  return {.state_bytes = 150 * n.bodies + 180 * contacts,
          .workspace_bytes = 900 * n.bodies + 1350 * contacts + 1000 * n.balls +
                             5000 * (n.joints + n.guided) + (d.joints.empty() ? 0 : 10e3),
          .elements = n.bodies,
          .seconds_per_step = seconds(d, n)};
}

}  // namespace truestep::rigid3d
