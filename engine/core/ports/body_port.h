// BodyPort: where couplings reach rigid bodies in space without knowing their system. An impulse J at the arm
// r from a body's centre of mass changes its motion by
//   dv = J / m,   dw = I^-1 (r x J),   K J = dv + dw x r   (what the place there gets);
// a position correction P there moves and turns it by the same amounts. P alone would change the angular
// momentum of the pair by P x (v_q - v) (q: the other's place); the spin compensates, so that corrections
// conserve it. Bodies whose rows are not free (links of a tree, bodies of the plane) answer through
// BodyAccess instead: an impulse on one may move others, and corrections conserve the tree's momentum.
#pragma once
#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "engine/core/ports/body_access.h"
#include "engine/core/state/real_column.h"
#include "engine/kernels/rigid/free_rotation.h"

namespace truestep {

struct Solid;

/// Properties shared by bodies of one kind.
struct BodyForm {
  const Solid* solid = nullptr;  ///< in the frame of centre and principal axes; null: collides with nothing
  double mass = 0;               ///< kg; 0: impulses do not move it
  Vec3 moments;                  ///< kg m^2; unused when the bodies have an access
};

/// The columns of a state that hold its bodies, f64 or f32, and the table of their forms. When the owner
/// provides an access, no column is read and a row is its own id.
struct BodyPort {
  State::Column position = 0, velocity = 0;             ///< rows x 3, of the centre of mass
  State::Column orientation = 0, angular_velocity = 0;  ///< rows x 4, of the principal axes; rows x 3, world
  State::Column form = 0;                               ///< u32, index into `forms`
  State::Column id = 0;                                 ///< u64, ascending and never used twice
  std::optional<State::Column> gravity = {};            ///< three numbers, m/s^2; empty: bodies do not fall
  std::span<const BodyForm> forms;
  const BodyOwner* owner = nullptr;  ///< null: bodies are free and never sleep

  /// Null: the columns hold free bodies.
  const BodyAccess* access() const { return owner ? owner->access() : nullptr; }
};

/// Cached lookups of bodies with an access, shared by all users of the same state.
struct BodyLookup {
  std::vector<BodyMotion> motions;
  bool fresh = false;
};

/// The bodies of one state; Real is double or const double. Valid until rows are added or removed. Bodies
/// with an access cache lookups in `memory`, which writing requires.
template <class Real>
class BodiesOf {
 public:
  using StateRef = typename RealColumn<Real>::StateRef;

  BodiesOf(StateRef s, const BodyPort& port, Workspace* memory = nullptr)
      : state_(s), port_(port), access_(port.access()), memory_(memory) {
    if (access_) {
      if (!memory_) return;
      access_->forget(*memory_);
      lookup_ = &memory_->template object<BodyLookup>("bodies.lookup"), lookup_->fresh = false;
      return;
    }
    place_ = {s, port.position}, velocity_ = {s, port.velocity};
    spin_ = {s, port.angular_velocity}, orientation_ = {s, port.orientation};
    form_ = std::as_const(s).template span<uint32_t>(port.form);
    ids_ = std::as_const(s).template span<uint64_t>(port.id);
  }

  size_t count() const { return access_ ? access_->count() : form_.size(); }
  uint32_t form_index(size_t row) const { return access_ ? access_->form(state_, row) : form_[row]; }
  const BodyForm& form(size_t row) const { return port_.forms[form_index(row)]; }
  bool dynamic(size_t row) const { return form(row).mass > 0; }
  /// Whether rows respond by a mass and moments of their own.
  bool free() const { return !access_; }
  uint64_t id_of(size_t row) const { return access_ ? row : ids_[row]; }
  std::optional<size_t> row_of(uint64_t id) const {
    if (access_) return id < count() ? std::optional<size_t>(id) : std::nullopt;
    const auto at = std::lower_bound(ids_.begin(), ids_.end(), id);
    if (at == ids_.end() || *at != id) return std::nullopt;
    return static_cast<size_t>(at - ids_.begin());
  }
  Vec3 place(size_t row) const { return access_ ? now(row).place : place_.vector(row); }
  Quat orientation(size_t row) const { return access_ ? now(row).orientation : orientation_.quaternion(row); }
  Vec3 velocity(size_t row) const { return access_ ? now(row).velocity : velocity_.vector(row); }
  Vec3 spin(size_t row) const { return access_ ? now(row).spin : spin_.vector(row); }
  /// m/s, of the body's place at this arm from its centre.
  Vec3 velocity_at(size_t row, const Vec3& arm) const { return velocity(row) + cross(spin(row), arm); }
  /// K J; zero for a body that impulses do not move.
  Vec3 answer(size_t row, const Vec3& arm, const Vec3& impulse) const {
    const BodyForm& f = form(row);
    if (!(f.mass > 0)) return {};
    if (access_) {
      const BodyTwist t = access_->answer(state_, row, {impulse, cross(arm, impulse)}, *memory_);
      return t.velocity + cross(t.spin, arm);
    }
    return impulse / f.mass +
           cross(free_rotation::spin_of(orientation(row), cross(arm, impulse), f.moments), arm);
  }
  /// How simultaneous impulses on all rows change every row; for bodies with an access.
  void answers(std::span<const BodyImpulse> impulses, std::span<BodyTwist> out) const {
    access_->answers(state_, impulses, out, *memory_);
  }
  /// n . K n, 1/kg.
  double inverse_mass(size_t row, const Vec3& arm, const Vec3& n) const {
    return dot(n, answer(row, arm, n));
  }

  /// N s at an arm; wakes the body.
  void push(size_t row, const Vec3& arm, const Vec3& impulse) {
    push_and_turn(row, impulse, cross(arm, impulse));
  }
  /// N s and N m s about the centre; wakes the body.
  void push_and_turn(size_t row, const Vec3& impulse, const Vec3& twist) {
    const BodyForm& f = form(row);
    if (!(f.mass > 0)) return;
    if (access_) {
      lookup_->fresh = false;
      return access_->push(state_, row, {impulse, twist}, *memory_);
    }
    wake(row);
    velocity_.set_vector(row, velocity(row) + impulse / f.mass);
    spin_.set_vector(row, spin(row) + free_rotation::spin_of(orientation(row), twist, f.moments));
  }
  /// Moves by `by` (m) and turns by a rotation vector (rad), keeping the angular momentum less `gained` (kg
  /// m^2/s). For free bodies.
  void move(size_t row, const Vec3& by, const Vec3& turn, const Vec3& gained = {}) {
    const BodyForm& f = form(row);
    if (!(f.mass > 0)) return;
    const Quat q = orientation(row), turned = normalized(free_rotation::turn(turn) * q);
    const Vec3 momentum = free_rotation::momentum({q, spin(row)}, f.moments) - gained;
    place_.set_vector(row, place(row) + by);
    orientation_.set_quaternion(row, turned);
    spin_.set_vector(row, free_rotation::spin_of(turned, momentum, f.moments));
  }
  /// Position correction P (kg m) at an arm; `gained`: the angular momentum that P adds to the pair it acts
  /// on.
  void shift(size_t row, const Vec3& arm, const Vec3& p, const Vec3& gained) {
    shift_and_turn(row, p, cross(arm, p), gained);
  }
  /// Corrections of position (kg m) and orientation (kg m^2 rad) about the centre.
  void shift_and_turn(size_t row, const Vec3& p, const Vec3& twist, const Vec3& gained) {
    const BodyForm& f = form(row);
    if (!(f.mass > 0)) return;
    if (access_) {
      lookup_->fresh = false;
      return access_->shift(state_, row, {p, twist}, gained, *memory_);
    }
    move(row, p / f.mass, free_rotation::spin_of(orientation(row), twist, f.moments), gained);
  }
  void wake(size_t row) {
    if (port_.owner) port_.owner->wake(state_, row);
  }

 private:
  /// For a body with an access.
  BodyMotion now(size_t row) const {
    if (!lookup_) return access_->motion(state_, row);
    if (!lookup_->fresh) {
      lookup_->motions.resize(count());
      access_->motions(state_, lookup_->motions, *memory_);
      lookup_->fresh = true;
    }
    return lookup_->motions[row];
  }

  StateRef state_;
  const BodyPort& port_;
  const BodyAccess* access_;
  Workspace* memory_;
  BodyLookup* lookup_ = nullptr;
  RealColumn<Real> place_, velocity_, spin_, orientation_;
  std::span<const uint32_t> form_;
  std::span<const uint64_t> ids_;
};
using Bodies = BodiesOf<double>;
using ConstBodies = BodiesOf<const double>;

}  // namespace truestep
