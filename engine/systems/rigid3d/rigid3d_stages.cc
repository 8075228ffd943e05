// The stages of a step: contacts, the solve, bodies without contacts, fast bodies, the number of substeps.
#include <algorithm>
#include <cmath>

#include "engine/kernels/rigid/fast_rotation.h"
#include "engine/kernels/rigid/impact_limits.h"
#include "engine/math/trig.h"
#include "engine/rigid/one_way.h"
#include "engine/rigid/toi_clamp.h"
#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::rigid3d {

using Part = BodyNow::Part;

namespace {
/// Steps between checks whether columns need another number of substeps.
constexpr uint64_t kStepsPerLook = 4;
/// Share of a core's radius by which it may be cut: at 1 its centre is on the surface, with no normal.
constexpr double kCentreInFront = 0.99;
}  // namespace

void Rigid3d::choose_substeps(State& s, const StepInput& in) const {
  if (in.step % kStepsPerLook != 0 || scratch(in).parts > 1) return;
  const int now = substeps(s, in.h);
  const int wanted =
      scratch(in).buckling.substeps(s, bodies_.kinds, scratch(in).contacts.all(), settings_, now, in.h);
  // In steps of one: the energy stored in contact springs changes with their stiffness. In the first step
  // they are hardly loaded beyond their offsets yet.
  const int next = std::clamp(wanted, now - 1, std::max(now + 1, in.step == 0 ? wanted : 0));
  if (next != now) change_substeps(s, in.h, now, next);
}

void Rigid3d::change_substeps(State& s, double h, int now, int next) const {
  // Impulses are those of one substep.
  const double share = static_cast<double>(now) / next;
  for (const auto c : {columns::contact_impulse, columns::contact_friction, columns::contact_roll,
                       columns::joint_impulse, columns::drive_impulse}) {
    for (double& impulse : s.f64(c)) impulse *= share;
  }
  // Offsets are the yields of the contact springs.
  if (!settings_.contact_hertz) {
    for (const auto c : {columns::contact_offset, columns::contact_uneven}) {
      for (double& offset : s.f64(c)) offset *= std::min(share * share, 1.0);
    }
  }
  s.f64(columns::substep)[0] = h / next;
}

void Rigid3d::find_contacts(State& s, const StepInput& in) const {
  Scratch& scratch = Rigid3d::scratch(in);
  double& substep = s.f64(columns::substep)[0];
  if (!(substep > 0)) substep = in.h / settings_.substeps;
  scratch.before.resize(s.rows(columns::position));
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  for (size_t i = 0; i < scratch.before.size(); ++i) scratch.before[i] = {load3(x, i), load_quat(q, i)};
  // Bodies joined to a moving body move too.
  const auto held = s.span<uint32_t>(columns::joint_bodies);
  const auto asleep = s.span<uint32_t>(columns::asleep), kind = s.span<uint32_t>(columns::kind),
             broken = s.span<uint32_t>(columns::joint_broken);
  const double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data(),
               *rested = s.f64(columns::sleep_timer).data();
  const auto moves = [&](uint32_t i) {
    const BodyKind& k = bodies_.kinds[kind[i]];
    if (k.moved_by_forces() && !is_led(rested, i)) return asleep[i] == 0;
    return k.motion != BodyDef::Motion::fixed && (load3(v, i) != Vec3{} || load3(w, i) != Vec3{});
  };
  for (size_t k = 0; k < held.size(); k += 2) {
    const uint32_t a = held[k], b = held[k + 1];
    if (a == kNoBody || b == kNoBody || broken[k / 2]) continue;
    if (asleep[a] && moves(b)) wake_body(s, a, bodies_.kinds);
    if (asleep[b] && moves(a)) wake_body(s, b, bodies_.kinds);
  }
  const int n = substeps(s, in.h);
  scratch.contacts.find(s, bodies_, joints_.joints, in, 0.5 * (n - 1) / n * in.h);
}

void Rigid3d::solve(State& s, const StepInput& in) const {
  Scratch& scratch = Rigid3d::scratch(in);
  SolverSettings settings = settings_;
  settings.restitution_speed =
      restitution_speed(load3(s.f64(columns::gravity).data(), 0), in.h * scratch.parts);
  settings.substeps = substeps(s, in.h);
  const bool starts = in.step == 0 && s.rows(columns::contact_bodies) == 0 && scratch.parts == 1;
  const auto run = [&](auto& solver) {
    if (starts) {
      // Columns would lean, and heavy bodies sink into light ones, until there are enough substeps.
      const auto contacts = scratch.contacts.all();
      solver.find_first_loads(s, bodies_.kinds, joints_, contacts, scratch.contacts.bodies(),
                              {scratch.change, scratch.twist}, settings, in);
      settings.substeps =
          scratch.buckling.substeps(s, bodies_.kinds, contacts, settings_, settings.substeps, in.h);
      s.f64(columns::substep)[0] = in.h / settings.substeps;
      for (Contact* c : contacts) std::fill_n(c->impulse, Manifold::kMost, 0.0);
    }
    solver.solve(s, bodies_.kinds, joints_, scratch.contacts.all(), scratch.contacts.bodies(),
                 {scratch.change, scratch.twist}, settings, in);
  };
  if (precision_ == Rigid3dDef::Precision::f32) {
    run(scratch.solver32);
  } else {
    run(scratch.solver64);
  }
  scratch.contacts.store(s);
}

void Rigid3d::integrate_free(State& s, const StepInput& in) const {
  Scratch& scratch = Rigid3d::scratch(in);
  const auto slot =
      precision_ == Rigid3dDef::Precision::f32 ? scratch.solver32.slots() : scratch.solver64.slots();
  const auto now = scratch.contacts.bodies();
  const auto kind = s.span<uint32_t>(columns::kind);
  double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data();
  const double h = in.h;
  in.arena.for_blocks(kind.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (now[i].part == Part::kinematic) {
        store3(x, i, load3(x, i) + load3(v, i) * h);
        store_quat(q, i, normalized(free_rotation::turn(load3(w, i) * h) * load_quat(q, i)));
        continue;
      }
      if (now[i].part != Part::active || slot[i] != kNoBody) continue;
      const BodyKind& b = bodies_.kinds[kind[i]];
      const Vec3 v0 = load3(v, i), a = scratch.change[i] / h;
      if (b.linear_damping == 0) {
        store3(x, i, load3(x, i) + (v0 + a * (0.5 * h)) * h);
        store3(v, i, v0 + scratch.change[i]);
      } else {
        // Exact solution of v' = a - c v.
        const double c = b.linear_damping, e = trig::exp(-c * h), m = (1 - e) / c;
        store3(x, i, load3(x, i) + v0 * m + a * ((h - m) / c));
        store3(v, i, v0 * e + a * m);
      }
      const double half = b.angular_damping == 0 ? 1 : trig::exp(-0.5 * b.angular_damping * h);
      Quat turned = load_quat(q, i);
      Vec3 spin = load3(w, i) * half;
      // Half of the change by a torque before and half after (Strang).
      if (!scratch.twist.empty())
        spin += free_rotation::spin_of(turned, scratch.twist[i] * 0.5, b.resistance());
      const auto m = free_rotation::advance_fast({turned, spin}, b.moments, h);
      turned = m.orientation, spin = m.angular_velocity;
      if (!scratch.twist.empty())
        spin += free_rotation::spin_of(turned, scratch.twist[i] * 0.5, b.resistance());
      store_quat(q, i, turned), store3(w, i, spin * half);
    }
  });
}

void Rigid3d::stop_fast_bodies(State& s, const StepInput& in) const {
  Scratch& scratch = Rigid3d::scratch(in);
  const auto now = scratch.contacts.bodies();
  const auto contacts = scratch.contacts.all();
  const auto kind = s.span<uint32_t>(columns::kind);
  double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  double* v = s.f64(columns::velocity).data();
  const auto pose = [&](size_t i) { return Pose{load3(x, i), load_quat(q, i)}; };
  const auto sweep = [&](size_t i) {
    return now[i].part == Part::active || now[i].part == Part::kinematic
               ? sweep_between(scratch.before[i], pose(i))
               : resting(scratch.before[i]);
  };
  const auto contact_of = [&](uint32_t a, uint32_t b) -> const Contact* {
    if (a > b) std::swap(a, b);
    const auto at =
        std::lower_bound(contacts.begin(), contacts.end(), uint64_t{a} << 32 | b,
                         [](const Contact* c, uint64_t key) { return (uint64_t{c->a} << 32 | c->b) < key; });
    return at != contacts.end() && (*at)->a == a && (*at)->b == b ? *at : nullptr;
  };
  const auto moved = [&](size_t i) { return load3(x, i) - scratch.before[i].position; };
  scratch.stopped.clear();
  for (uint32_t i = 0; i < kind.size(); ++i) {
    if (now[i].part != Part::active) continue;
    const BodyKind& k = bodies_.kinds[kind[i]];
    const double move = norm(load3(x, i) - scratch.before[i].position);
    // A triangle surface has no core to sweep.
    if (k.sensor || !(k.inner > 0) || !may_pass_through(move + in.h * now[i].turn_speed, k.inner)) continue;
    Box box = bounds(k.solid, now[i].at);
    box.cover(bounds(k.solid, transform_of(pose(i))));
    scratch.near.clear();
    scratch.contacts.broad_phase().overlapping(box, [&](uint32_t j) { scratch.near.push_back(j); });
    const Sweep own = sweep(i);
    const Solid core = sphere_solid(kToiCore * k.inner);
    double first = 1;
    for (const uint32_t j : scratch.near) {
      const BodyKind& o = bodies_.kinds[kind[j]];
      if (j == i || o.sensor || !filter_allows(k, o) || scratch.contacts.joined(i, j)) {
        continue;
      }
      // A body in contact from the start may go on moving, but its core must not pass through.
      std::optional<Impact> hit;
      const Sweep other = sweep(j);
      const Contact* c = contact_of(i, j);
      if (!c && !scratch.contacts.at_seam(i, j)) {
        hit = time_of_impact(k.solid, own, o.solid, other, 0.25 * now[i].margin);
        // A body inside a one-way body already passes it, as does one that comes from its open side.
        const Vec3 up = o.one_way ? now[j].at.direction(o.one_way_direction) : Vec3{};
        if (o.one_way &&
            (!hit || hit->t == 0 || !one_way_holds(-dot(hit->normal, up), dot(own.move - other.move, up)))) {
          continue;
        }
        if (hit && scratch.contacts.meets_seam(s, bodies_.kinds, i, j, *hit)) hit.reset();
      }
      if (!hit || hit->t == 0) hit = time_of_impact(core, own, o.solid, other, 0.1 * k.inner);
      // Overlapping cores may separate, and a body close to a wall may leave it, as may one whose core is cut
      // by the wall while its centre is in front of it: pressed that deep, it would otherwise be held there
      // for ever. A centre inside a wall has no side to return to.
      const bool parting = c && dot(c->manifold.normal, moved(c->b) - moved(c->a)) > 0;
      if (hit && hit->t == 0 && now[j].gives_way() && parting) continue;
      const double in_front = is_convex_or_plane(o.solid.kind) ? -kCentreInFront * kToiCore * k.inner : 0;
      if (hit && hit->t == 0 && hit->gap > in_front && dot(hit->normal, own.move - other.move) < 0) continue;
      if (hit && hit->t < first) first = hit->t;
    }
    if (first < 1) scratch.stopped.push_back({i, first});
  }
  for (const auto& [i, t] : scratch.stopped) {
    const Sweep own = sweep(i);
    store3(x, i, own.from.position + own.move * t);
    // A body stopped at once still rotates; otherwise a stuck corner would stay stuck.
    if (t > 0) store_quat(q, i, normalized(free_rotation::turn(own.turn * t) * own.from.orientation));
    // Forces must not act during the time lost: a body set back would otherwise keep the speed of the fall.
    store3(v, i, load3(v, i) - scratch.change[i] * (1 - t));
  }
}

}  // namespace truestep::rigid3d
