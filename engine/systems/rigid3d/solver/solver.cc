#include "engine/systems/rigid3d/solver/solver.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "engine/kernels/rigid/fast_rotation.h"
#include "engine/kernels/rigid/record_math.h"
#include "engine/rigid/free_flight.h"

namespace truestep::rigid3d {

namespace {

/// Maximum rounds of impacts passed on between bodies in one substep; the rest does not bounce.
constexpr int kImpactRounds = 64;
/// Fraction of push_out_speed up to which the speed of pushes is left to the relaxation, which removes most
/// of it: walls and towers lean where positions are corrected separately from velocities.
constexpr double kGentlePush = 0.25;
/// Sweeps of pushes where heavy bodies are lightened: pushes that are taken back do not add up.
constexpr int kLighterSweeps = 6;
/// rad/s; the axis of rotation of slower bodies changes by less than the resolution of a float.
constexpr double kSlowSpin = 1e-2;

ColourOrder reversed(ColourOrder order) {
  return order == ColourOrder::forth ? ColourOrder::back : ColourOrder::forth;
}

Vec3 roots(const Vec3& a) {
  return {std::sqrt(a.x), std::sqrt(a.y), std::sqrt(a.z)};
}

/// Change of a spin (rad/s) about principal axes by free rotation for a time h.
Vec3 gyroscopic_change(const Vec3& spin, const Vec3& moments, double h) {
  if (norm2(spin) <= kSlowSpin * kSlowSpin) return {};
  if (moments.x == moments.y && moments.y == moments.z) return {};
  const auto m = free_rotation::advance_fast({{}, spin}, moments, h);
  return rotation(m.orientation).apply_inverse(m.angular_velocity) - spin;
}

/// S^T a.
Vec3 apply_transposed(const double s[9], const Vec3& a) {
  return {s[0] * a.x + s[3] * a.y + s[6] * a.z, s[1] * a.x + s[4] * a.y + s[7] * a.z,
          s[2] * a.x + s[5] * a.y + s[8] * a.z};
}
template <class T>
Record8<T> record(const Vec3& linear, const Vec3& turn) {
  return {{T(linear.x), T(linear.y), T(linear.z), T(turn.x), T(turn.y), T(turn.z), 0, 0}};
}

}  // namespace

template <class T>
void ContactSolver<T>::choose_bodies(const State& s, std::span<const BodyKind> kinds,
                                     std::span<Contact* const> contacts, std::span<const BodyNow> now) {
  const auto kind = s.span<uint32_t>(columns::kind);
  slot_.assign(kind.size(), kNoBody);
  listed_.clear();
  // Contacts between two moving bodies come first: the ground is solved after its load.
  enum class Ends : uint8_t { both_move, one_moves };
  const auto list = [&](Ends ends) {
    for (uint32_t k = 0; k < contacts.size(); ++k) {
      const uint32_t a = contacts[k]->a, b = contacts[k]->b;
      const BodyKind &ka = kinds[kind[a]], &kb = kinds[kind[b]];
      if (ka.sensor || kb.sensor) continue;
      const bool moves_a = now[a].part == BodyNow::Part::active,
                 moves_b = now[b].part == BodyNow::Part::active;
      if (moves_a) slot_[a] = 0;
      if (moves_b) slot_[b] = 0;
      // What is led meets what is fixed.
      if (!moves_a && !moves_b) continue;
      if ((moves_a && moves_b) == (ends == Ends::both_move)) listed_.push_back(k);
    }
  };
  list(Ends::both_move), list(Ends::one_moves);
  joints_.choose(s, now, slot_);
  jointed_ = !joints_.listed().empty();
  body_.clear();
  for (uint32_t i = 0; i < slot_.size(); ++i) {
    if (slot_[i] == 0) slot_[i] = static_cast<uint32_t>(body_.size()), body_.push_back(i);
  }
}

template <class T>
void ContactSolver<T>::load_bodies(const State& s, std::span<const BodyKind> kinds,
                                   std::span<const BodyNow> now, const ForceChange& change,
                                   const SolverSettings& settings, double h) {
  const auto kind = s.span<uint32_t>(columns::kind);
  const double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data();
  const size_t n = body_.size();
  scaled_.resize(n), moments_.resize(n), island_.resize(n), parts_.resize(n);
  for (auto* r : {&velocity_, &displacement_, &change_, &warm_, &start_}) r->resize(n + 1);
  if (jointed_) turning_.resize(n), moved_.resize(n + 1), cross_.resize(n + 1);
  damped_ = false;
  const double part = 1.0 / settings.substeps;
  twist_.resize(change.momentum.empty() ? 0 : n);
  const auto load = [&](size_t k) {
    const uint32_t i = body_[k];
    const BodyKind& b = kinds[kind[i]];
    const double root = std::sqrt(b.mass);
    const Vec3 r = roots(b.moments);
    const Rotation& R = now[i].at.rotation;
    scaled_[k] = scaled_body(b, R), moments_[k] = b.moments;
    if (jointed_) {
      const bool ball = b.moments.x == b.moments.y && b.moments.y == b.moments.z;
      turning_[k] = {r, free_rotation::spin_ratios(b.moments), {}, !ball, false};
      cross_[k] = record<T>({r.x / (r.y * r.z), r.y / (r.z * r.x), r.z / (r.x * r.y)}, {});
    }
    const Vec3 spin = load3(w, i), own = R.apply_inverse(spin);
    velocity_[k] = record<T>(load3(v, i) * root, free_rotation::times(own, r));
    Vec3 turned = jointed_ ? Vec3{} : gyroscopic_change(own, b.moments, h) * part;
    if (!twist_.empty()) {
      twist_[k] = free_rotation::divide(R.apply_inverse(change.momentum[i]), b.resistance()) * part;
      turned += twist_[k];
    }
    change_[k] = record<T>(change.velocity[i] * (root * part), free_rotation::times(turned, r));
    displacement_[k] = {}, warm_[k] = {};
  };
  each_body(load);
  for (size_t k = 0; k < n; ++k) {
    const BodyKind& b = kinds[kind[body_[k]]];
    damped_ |= b.linear_damping > 0 || b.angular_damping > 0;
  }
  flight_.resize(n);
  velocity_[n] = {}, displacement_[n] = {}, warm_[n] = {}, change_[n] = {};
  if (!damped_) return;
  damping_.resize(n);
  for (size_t k = 0; k < n; ++k) {
    const BodyKind& b = kinds[kind[body_[k]]];
    const double l = 1 / (1 + h * part * b.linear_damping), a = 1 / (1 + h * part * b.angular_damping);
    damping_[k] = record<T>({l, l, l}, {a, a, a});
  }
}

template <class T>
void ContactSolver<T>::substeps(const State& s, const JointList& joints, const SolverSettings& settings,
                                const StepInput& in) {
  const size_t n = body_.size();
  const auto end = static_cast<uint32_t>(n);
  const double h = in.h / settings.substeps;
  const auto soft = contact_softness(settings, h);
  ContactPass<T> pass{T(1 / h),
                      0,
                      T(soft.bias_rate),
                      T(soft.mass_scale),
                      T(soft.impulse_scale),
                      T(settings.push_out_speed),
                      T(kGentlePush * settings.push_out_speed)};
  Record8<T>*v = velocity_.data(), *d = displacement_.data();
  for (size_t g = 0; g < contact_lanes_.count; ++g) flags_ |= groups_[g].flags;
  const bool bounces = flags_ & ContactGroup<T>::kBounces, flies = bounces && !jointed_;
  std::atomic<bool> deep = false;
  const auto look = [&](const ContactGroup<T>& g) {
    if (any_below(depth_left(g, pass), W(0))) deep.store(true, std::memory_order_relaxed);
  };
  each_colour(contact_lanes_, groups_, team_, [&](ContactGroup<T>& g) {
    apply_contacts(g, warm_.data(), end);
    look(g);
  });
  joints_.start(joints, d, warm_.data(), h, team_);
  balls_.start(warm_.data(), team_);
  if (springs_) joints_.loosen(joints, held_, sprung_, h), kick(T(-1));
  for (int k = 0; k < settings.substeps; ++k) {
    const auto warm_start = [&](size_t i) { records::add(v[i], warm_[i]), start_[i] = v[i]; };
    each_body([&](size_t i) {
      if (flies) flight_[i] = v[i];
      act(i, v[i]);
      if (!bounces) warm_start(i);
    });
    // Before warm starting: impacts use the actual velocities of the bodies.
    if (bounces && hit({T(h), T(settings.restitution_speed)}, settings.substeps - 1 - k)) {
      // What is no longer going to touch must not be slowed by the solver.
      each_body([&](size_t i) { records::add(d[i], toi_correction_[i]); });
      each_colour(contact_lanes_, groups_, team_,
                  [&](ContactGroup<T>& g) { update_separations(g, d, T(k * h)); });
    }
    if (bounces) each_body(warm_start);
    // Alternating: sweeps in one order only would feed energy to bodies that rest on several others, because
    // their warm-start impulses add up what the sweeps left (eigenvalues of the iteration become complex).
    const ColourOrder order = k % 2 == 0 ? ColourOrder::forth : ColourOrder::back;
    const bool parts = deep.exchange(false);
    pass.start = parts ? start_.data() : nullptr;
    if (parts) start_parting(pass);
    joints_.pull(v, team_);
    joints_.bias(v, team_);
    balls_.bias(v, team_);
    const bool lighter = parts && lighten();
    ColourOrder way = order;
    for (int sweeps = lighter ? kLighterSweeps : 1; sweeps > 0; --sweeps, way = reversed(way)) {
      each_colour(contact_lanes_, groups_, team_, way,
                  [&](ContactGroup<T>& g) { solve_contacts<ContactSolve::bias>(g, v, d, end, pass); });
    }
    if (lighter) weigh_bodies(Masses::own);
    if (jointed_) move_jointed(T(h));
    each_body([&](size_t i) {
      if (!jointed_) records::add_times(d[i], T(h), v[i]);
      if (flies) keep_on_parabola(i, T(h));
      if (bounces && jointed_) records::add(moved_[i], toi_correction_[i]);
    });
    pass.elapsed = T((k + 1) * h);
    // Velocities must satisfy the joints at the new positions: with the directions of the old ones a swinging
    // body would lose (h w)^2 of its energy per substep.
    const Renewal renewal = k + 1 < settings.substeps ? Renewal::goes_on : Renewal::last;
    joints_.renew(d, warm_.data(), pass.elapsed, renewal, team_);
    balls_.renew(moved_.data(), warm_.data(), renewal, team_);
    if (lighter) weigh_bodies(Masses::light);
    if (parts) {
      each_colour(contact_lanes_, groups_, team_, [&](ContactGroup<T>& g) { take_push_back(g, v, end); });
    }
    if (lighter) weigh_bodies(Masses::own), weigh_contacts(Masses::own);
    joints_.relax(v, team_);
    balls_.relax(v, team_);
    const auto relax = [&](ColourOrder way) {
      each_colour(contact_lanes_, groups_, team_, way, [&](ContactGroup<T>& g) {
        solve_contacts<ContactSolve::relax>(g, v, d, end, pass);
        look(g);
      });
    };
    // Where many bodies overlap, one sweep per substep is not enough with an even number of substeps: with
    // velocities v and a sweep G, warm starts give v'' = G (2 v' - v), which grows for eigenvalues of G below
    // -1/3. With a sweep in each direction per substep, G has none below 0.
    relax(order);
    if (parts) relax(reversed(order));
    each_body([&](size_t i) { records::add_difference(warm_[i], v[i], start_[i]); });
  }
  if (springs_) kick(T(1));
}

template <class T>
void ContactSolver<T>::act(size_t i, Record8<T>& v) const {
  records::add(v, change_[i]);
  if (damped_) records::multiply(v, damping_[i]);
}

template <class T>
void ContactSolver<T>::keep_on_parabola(size_t i, T h) {
  Record8<T> free = flight_[i];
  act(i, free);
  end_on_parabola<6>(velocity_[i].x, free.x, flight_[i].x, T(0.5) * h, displacement_[i].x);
}

template <class T>
void ContactSolver<T>::set_turned(size_t i, const Vec3& gyroscopic) {
  const Vec3 r = roots(moments_[i]), turned = twist_.empty() ? gyroscopic : gyroscopic + twist_[i];
  change_[i].x[3] = T(turned.x * r.x), change_[i].x[4] = T(turned.y * r.y),
  change_[i].x[5] = T(turned.z * r.z);
}

template <class T>
void ContactSolver<T>::choose_sprung(const State& s, const JointList& joints,
                                     std::span<Contact* const> contacts) {
  springs_ = !damped_ && joints_.has_springs(joints);
  if (!springs_) return;
  held_.assign(body_.size(), 0), sprung_.assign(body_.size(), 0);
  for (const uint32_t k : listed_) {
    for (const uint32_t i : {contacts[k]->a, contacts[k]->b}) {
      if (slot_[i] != kNoBody) held_[slot_[i]] = 1;
    }
  }
  joints_.mark_held(s, joints, slot_, held_);
}

template <class T>
void ContactSolver<T>::kick(T times) {
  Record8<T>* v = velocity_.data();
  for (size_t i = 0; i < body_.size(); ++i) {
    if (!sprung_[i]) continue;
    for (int e = 0; e < 8; ++e) v[i].x[e] += T(0.5) * times * change_[i].x[e];
  }
  joints_.kick(v, times, team_);
}

template <class T>
bool ContactSolver<T>::hit(const ImpactPass<T>& pass, int substeps_left) {
  const size_t n = body_.size();
  const auto end = static_cast<uint32_t>(n);
  toi_correction_.assign(n + 1, {}), last_hit_.assign(n + 1, 0);
  std::copy_n(velocity_.begin(), n, start_.begin());
  const ImpactRecords<T> bodies{velocity_.data(), change_.data(), toi_correction_.data(), last_hit_.data()};
  std::atomic<bool> any = false;
  each_colour(contact_lanes_, groups_, team_, [&](ContactGroup<T>& g) {
    if (!(g.flags & ContactGroup<T>::kBounces)) return;
    if (hit_contacts<Hits::bouncing>(g, bodies, end, pass)) any = true;
  });
  if (!any) return false;
  // An impact is passed on through contacts that do not bounce.
  for (int round = 1; round < kImpactRounds && any; ++round) {
    any = false;
    each_colour(contact_lanes_, groups_, team_, [&](ContactGroup<T>& g) {
      if (hit_contacts<Hits::all>(g, bodies, end, pass)) any = true;
    });
  }
  // A body whose spin has changed has different gyroscopic torques for the rest of the step.
  for (size_t i = 0; i < n && substeps_left > 0 && !jointed_; ++i) {
    const T *v = velocity_[i].x, *before = start_[i].x;
    if (std::equal(v + 3, v + 6, before + 3)) continue;
    const Vec3 r = roots(moments_[i]), turn{double(v[3]), double(v[4]), double(v[5])};
    const Vec3 own{turn.x / r.x, turn.y / r.y, turn.z / r.z};
    const Vec3 turned = gyroscopic_change(own, moments_[i], substeps_left * double(pass.h)) / substeps_left;
    set_turned(i, turned);
  }
  return true;
}

template <class T>
void ContactSolver<T>::store_bodies(State& s) {
  find_carried();
  double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data();
  each_body([&](size_t k) {
    const uint32_t i = body_[k];
    const ScaledBody& b = scaled_[k];
    const T *r = velocity_[k].x, *d = displacement_[k].x;
    store3(v, i, Vec3{double(r[0]), double(r[1]), double(r[2])} * b.root);
    store3(x, i, load3(x, i) + Vec3{double(d[0]), double(d[1]), double(d[2])} * b.root);
    // Both rotations are in the body's frame: w in that of its orientation at the end.
    const Quat from = load_quat(q, i);
    const Rotation R = rotation(from);
    const Vec3 turn = apply_transposed(b.turn, {double(d[3]), double(d[4]), double(d[5])});
    const Quat to = normalized(free_rotation::turn(turn) * from);
    const Vec3 own = R.apply_inverse(apply_transposed(b.turn, {double(r[3]), double(r[4]), double(r[5])}));
    const bool stays = !carried_.empty() && carried_[k];
    store_quat(q, i, to), store3(w, i, (stays ? R : rotation(to)).apply(own));
  });
}

template <class T>
void ContactSolver<T>::fill_rows(const State& s, std::span<const BodyKind> kinds, const JointList& joints,
                                 std::span<Contact* const> contacts, std::span<const BodyNow> now,
                                 const ForceChange& change, const SolverSettings& settings,
                                 const StepInput& in) {
  load_bodies(s, kinds, now, change, settings, in.h);
  if (jointed_) {
    find_driven(s, joints);
  } else {
    driven_.clear();
  }
  ends_.clear(), many_.clear();
  for (const uint32_t k : listed_) {
    ends_.push_back({slot_[contacts[k]->a], slot_[contacts[k]->b]});
    many_.push_back(contacts[k]->manifold.count > 2);
  }
  // The lane with the most points determines the time of a group.
  make_lanes(listed_, ends_, many_, body_.size(), W::kLanes, colouring_, contact_lanes_);
  if (groups_.size() < contact_lanes_.count) groups_.resize(contact_lanes_.count + contact_lanes_.count / 4);
  team_.for_blocks(contact_lanes_.count, kGroupsPerBlock, [&](size_t begin, size_t end) {
    for (size_t g = begin; g < end; ++g) fill(g, contacts, s, kinds, now, in.h);
  });
  choose_sprung(s, joints, contacts);
  const typename JointSolver<T>::Bodies bodies{now, slot_, scaled_, body_.size()};
  balls_.take(joints_.listed(), s, joints.joints, now);
  const double h = in.h / settings.substeps;
  balls_.fill(s, joints.joints, bodies, h, team_);
  joints_.fill(s, joints, bodies, h, team_);
  flags_ = 0;
}

template <class T>
void ContactSolver<T>::solve(State& s, std::span<const BodyKind> kinds, const JointList& joints,
                             std::span<Contact* const> contacts, std::span<const BodyNow> now,
                             const ForceChange& change, const SolverSettings& settings, const StepInput& in) {
  choose_bodies(s, kinds, contacts, now);
  if (body_.empty()) return;
  const auto gathering = team_.gather(in.arena);
  fill_rows(s, kinds, joints, contacts, now, change, settings, in);
  if (s.rows(columns::contact_bodies) == 0 && in.step == 0) {
    find_loads(s, kinds, contacts, now, settings, in.h);
  }
  substeps(s, joints, settings, in);
  store_impulses(contacts, penetration_offset_rule(settings, in.h));
  store_bodies(s);
  const double h = in.h / settings.substeps;
  joints_.store(s, joints, h);
  balls_.store(s, joints.joints, h);
}

template class ContactSolver<float>;
template class ContactSolver<double>;

}  // namespace truestep::rigid3d
