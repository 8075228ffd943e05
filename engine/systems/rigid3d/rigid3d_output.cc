// Observables and fields of a rigid3d state: energies, momenta.
#include <algorithm>
#include <cmath>

#include "engine/kernels/rigid/free_rotation.h"
#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::rigid3d {

namespace {
enum Field : size_t {
  kPosition,
  kVelocity,
  kOrientation,
  kAngularVelocity,
  kAsleep,
  kShape,
  kSize,
  kContactForce,
  kContactLoad,
  kJointForce,
  kJointTorque
};

// Power in W of a body's constant torque, and of its constant force where that turns with the body.
double applied_power(const BodyKind& b, const Quat& q, const Vec3& v, const Vec3& w) {
  const Rotation R = rotation(q);
  return b.force_turns ? dot(R.apply(b.force), v) + dot(R.apply(b.torque), w) : dot(b.torque, w);
}
}  // namespace

void Rigid3d::observe(const State& s, double, Observables& out) const {
  const auto kind = s.span<uint32_t>(columns::kind);
  const auto asleep = s.span<uint32_t>(columns::asleep);
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  const double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data();
  const Vec3 g = load3(s.f64(columns::gravity).data(), 0);
  double linear = 0, turning = 0, potential = spring_energy(s), power = 0, awake = 0, fastest = 0;
  Vec3 momentum, spin;
  for (size_t i = 0; i < kind.size(); ++i) {
    const BodyKind& b = bodies_.kinds[kind[i]];
    if (!b.moved_by_forces()) continue;
    const Vec3 p = load3(v, i) * b.mass;
    const Vec3 L = free_rotation::momentum({load_quat(q, i), load3(w, i)}, b.moments);
    linear += 0.5 * dot(p, load3(v, i)), turning += 0.5 * dot(L, load3(w, i));
    potential -= b.mass * b.gravity_scale * dot(g, load3(x, i));
    if (b.forced()) power += applied_power(b, load_quat(q, i), load3(v, i), load3(w, i));
    if (!b.force_turns) potential -= dot(b.force, load3(x, i));
    momentum += p, spin += L + cross(load3(x, i), p);
    awake += asleep[i] == 0;
    fastest = std::max(fastest, norm(load3(v, i)));
  }
  const double kinetic = linear + turning;
  out.add("energy.kinetic", kinetic, "J");
  out.add("energy.rotation", turning, "J");
  out.add("energy.potential", potential, "J");
  out.add("energy.total", kinetic + potential, "J");
  const auto forced = [](const BodyKind& k) { return k.forced(); };
  if (std::any_of(bodies_.kinds.begin(), bodies_.kinds.end(), forced)) out.add("power.applied", power, "W");
  out.add("momentum.x", momentum.x, "kg m/s");
  out.add("momentum.y", momentum.y, "kg m/s");
  out.add("momentum.z", momentum.z, "kg m/s");
  out.add("angular_momentum.x", spin.x, "kg m^2/s");
  out.add("angular_momentum.y", spin.y, "kg m^2/s");
  out.add("angular_momentum.z", spin.z, "kg m^2/s");
  out.add("speed.largest", fastest, "m/s");
  out.add("count", static_cast<double>(kind.size()), "1");
  out.add("awake", awake, "1");
  out.add("substeps", substeps(s, dt_), "1");
  out.add("contacts", static_cast<double>(s.rows(columns::contact_bodies)), "1");
  const auto bodies = s.span<uint32_t>(columns::contact_bodies);
  const auto depths = s.f64(columns::contact_depth);
  double deepest = 0, sensed = 0;
  for (size_t k = 0; k < depths.size(); ++k) {
    const bool sensor =
        bodies_.kinds[kind[bodies[2 * k]]].sensor || bodies_.kinds[kind[bodies[2 * k + 1]]].sensor;
    sensed += sensor;
    if (!sensor) deepest = std::max(deepest, depths[k]);
  }
  out.add("penetration", deepest, "m");
  out.add("sensed", sensed, "1");
  observe_joints(s, out);
}

std::optional<Energy> Rigid3d::energy(const State& s, double, Workspace&, const ThreadArena&) const {
  const auto kind = s.span<uint32_t>(columns::kind);
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  const double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data();
  const Vec3 g = load3(s.f64(columns::gravity).data(), 0);
  const double pushed = settings_.push_out_speed;
  Energy e;
  bool driven = joints_drive(s) || columns::kHands.any(s);
  for (size_t i = 0; i < kind.size(); ++i) {
    const BodyKind& b = bodies_.kinds[kind[i]];
    const Vec3 u = load3(v, i), spin = load3(w, i);
    driven = driven || b.conveys();
    if (!b.moved_by_forces()) {
      driven = driven || norm2(u) + norm2(spin) > 0;
      continue;
    }
    driven = driven || b.forced();
    const Vec3 L = free_rotation::momentum({load_quat(q, i), spin}, b.moments);
    e.kinetic += 0.5 * b.mass * norm2(u) + 0.5 * dot(L, spin);
    e.potential -= b.mass * b.gravity_scale * dot(g, load3(x, i));
    e.slack += b.mass * (0.5 * pushed * pushed + std::abs(b.gravity_scale) * norm(g) * b.reach);
  }
  e.potential += spring_energy(s);
  e.exchange = driven ? Energy::Exchange::open : Energy::Exchange::closed;
  return e;
}

void Rigid3d::name_parts() {
  PartInfo bodies;
  bodies.fields = {{"position", "m", Scalar::f64, 3, Meaning::position},
                   {"velocity", "m/s", Scalar::f64, 3, Meaning::velocity},
                   {"orientation", "1", Scalar::f64, 4, Meaning::orientation},
                   {"angular_velocity", "rad/s", Scalar::f64, 3},
                   {"asleep", "1", Scalar::u32, 1, Meaning::asleep},
                   {"shape", "1"},
                   {"size", "m", Scalar::f64, 3},
                   {"contact_force", "N", Scalar::f64, 3},
                   {"contact_load", "N"},
                   {"joint_force", "N", Scalar::f64, 3},
                   {"joint_torque", "N m", Scalar::f64, 3}};
  bodies.max_rows = most_bodies_;
  std::vector<PartInfo> parts{std::move(bodies)};
  if (!joints_.joints.empty()) {
    PartInfo& joints = parts.emplace_back();
    joints.kind = PartInfo::Kind::values;
    joints.name = "joints";
    joints.elements = PartInfo::Elements::joints;
    joints.fields = {{"force", "N", Scalar::f64, 3}, {"torque", "N m", Scalar::f64, 3}};
    joints.max_rows = joints_.joints.size();
  }
  set_parts(std::move(parts));
}

FieldView Rigid3d::field(const State& s, size_t part, size_t which, std::vector<double>& scratch) const {
  if (part == 1) {
    const size_t joints = joints_.joints.size();
    scratch.assign(3 * joints, 0);
    const double* load = s.f64(columns::joint_load).data();
    for (size_t k = 0; k < joints; ++k) {
      if (!s.span<uint32_t>(columns::joint_broken)[k]) store3(scratch.data(), k, load3(load, 2 * k + which));
    }
    return {scratch.data(), Scalar::f64, joints, 3};
  }
  const size_t n = s.rows(columns::position);
  const auto kind = s.span<uint32_t>(columns::kind);
  switch (which) {
    case kPosition:
      return {s.f64(columns::position).data(), Scalar::f64, n, 3};
    case kVelocity:
      return {s.f64(columns::velocity).data(), Scalar::f64, n, 3};
    case kOrientation:
      return {s.f64(columns::orientation).data(), Scalar::f64, n, 4};
    case kAngularVelocity:
      return {s.f64(columns::angular_velocity).data(), Scalar::f64, n, 3};
    case kAsleep:
      return {s.span<uint32_t>(columns::asleep).data(), Scalar::u32, n, 1};
    case kShape:
      scratch.resize(n);
      for (size_t i = 0; i < n; ++i) scratch[i] = static_cast<double>(bodies_.kinds[kind[i]].solid.kind);
      return {scratch.data(), Scalar::f64, n, 1};
    case kSize:
      scratch.resize(3 * n);
      for (size_t i = 0; i < n; ++i) store3(scratch.data(), i, bodies_.kinds[kind[i]].solid.size);
      return {scratch.data(), Scalar::f64, n, 3};
    case kJointForce:
    case kJointTorque:
      scratch.resize(3 * n);
      joint_loads(s, which == kJointForce ? JointLoad::force : JointLoad::torque, scratch);
      return {scratch.data(), Scalar::f64, n, 3};
    case kContactLoad:
      scratch.resize(n);
      contact_loads(s, scratch);
      return {scratch.data(), Scalar::f64, n, 1};
    default:
      break;
  }
  scratch.resize(3 * n);
  contact_forces(s, scratch);
  return {scratch.data(), Scalar::f64, n, 3};
}

namespace {
// N s, sum of the normal impulses at the points of contact k.
double normal_impulse(const State& s, size_t k) {
  const double* impulse = s.f64(columns::contact_impulse).data() + 4 * k;
  return impulse[0] + impulse[1] + impulse[2] + impulse[3];
}
}  // namespace

void Rigid3d::contact_forces(const State& s, std::span<double> out) const {
  std::fill(out.begin(), out.end(), 0.0);
  const double h = s.f64(columns::substep)[0];
  if (!(h > 0)) return;
  const auto bodies = s.span<uint32_t>(columns::contact_bodies);
  const double *normal = s.f64(columns::contact_normal).data(),
               *friction = s.f64(columns::contact_friction).data();
  for (size_t k = 0; k < s.rows(columns::contact_bodies); ++k) {
    const Vec3 slide{friction[4 * k], friction[4 * k + 1], friction[4 * k + 2]};
    const Vec3 force = (load3(normal, k) * normal_impulse(s, k) + slide) / h;
    const size_t a = bodies[2 * k], b = bodies[2 * k + 1];
    store3(out.data(), a, load3(out.data(), a) - force);
    store3(out.data(), b, load3(out.data(), b) + force);
  }
}

void Rigid3d::contact_loads(const State& s, std::span<double> out) const {
  std::fill(out.begin(), out.end(), 0.0);
  const double h = s.f64(columns::substep)[0];
  if (!(h > 0)) return;
  const auto bodies = s.span<uint32_t>(columns::contact_bodies);
  for (size_t k = 0; k < s.rows(columns::contact_bodies); ++k) {
    const double load = normal_impulse(s, k) / h;
    out[bodies[2 * k]] += load, out[bodies[2 * k + 1]] += load;
  }
}

}  // namespace truestep::rigid3d
