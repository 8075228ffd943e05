#include "engine/systems/rigid3d/rigid3d_state.h"

#include <algorithm>

#include "engine/rigid/constraint_colouring.h"
#include "engine/rigid/islands.h"

namespace truestep::rigid3d {

State rigid3d_at_start(const BodyList& bodies, const JointList& list, const Vec3& gravity) {
  using S = Scalar;
  const auto& joints = list.joints;
  State s;
  s.add({"position", "m", S::f64, 3, Role::position}, 0);
  s.add({"velocity", "m/s", S::f64, 3, Role::velocity}, 0);
  s.add({"orientation", "1", S::f64, 4, Role::position}, 0);
  s.add({"angular_velocity", "rad/s", S::f64, 3, Role::velocity}, 0);
  s.add({"kind", "1", S::u32, 1}, 0);
  s.add({"id", "1", S::u64, 1}, 0);
  s.add({"sleep_timer", "s", S::f64, 1}, 0);
  s.add({"sleep_position", "m", S::f64, 3}, 0);
  s.add({"sleep_orientation", "1", S::f64, 4}, 0);
  s.add({"sleep_middle", "m", S::f64, 6}, 0);
  s.add({"asleep", "1", S::u32, 1}, 0);
  s.add({"contact.bodies", "1", S::u32, 2}, 0);
  s.add({"contact.ids", "1", S::u32, 5}, 0);
  s.add({"contact.normal", "1", S::f64, 3}, 0);
  s.add({"contact.impulse", "N s", S::f64, 4}, 0);
  s.add({"contact.penetration_offset", "m", S::f64, 1}, 0);
  s.add({"contact.uneven_offset", "m", S::f64, 4}, 0);
  s.add({"contact.friction", "SI", S::f64, 4}, 0);
  s.add({"contact.roll", "N m s", S::f64, 3}, 0);
  s.add({"contact.depth", "m", S::f64, 1}, 0);
  s.add({"joint.bodies", "1", S::u32, 2}, joints.size());
  s.add({"joint.impulse", "SI", S::f64, 6}, joints.size());
  s.add({"joint.load", "SI", S::f64, 6}, joints.size());
  s.add({"joint.broken", "1", S::u32, 1}, joints.size());
  s.add({"drive.impulse", "SI", S::f64, 4}, list.drives.size());
  s.add({"drive.coordinate", "SI", S::f64, 1}, list.drives.size());
  s.add({"drive.motor", "SI", S::f64, 2, Role::sentinel}, list.drives.size());
  for (size_t k = 0; k < list.drives.size(); ++k) {
    const Drive& d = list.drives[k];
    const Joint& j = joints[d.joint];
    const auto pose = [&](uint32_t i) { return i == kNoBody ? Pose{} : bodies.starts[i].pose; };
    s.f64(columns::drive_coordinate)[k] =
        joint_place(j, pose(j.bodies[0]), pose(j.bodies[1])).coordinate[d.row];
    s.f64(columns::drive_motor)[2 * k] = d.motor_target;
    s.f64(columns::drive_motor)[2 * k + 1] = d.max_motor;
  }
  for (size_t k = 0; k < joints.size(); ++k) {
    s.span<uint32_t>(columns::joint_bodies)[2 * k] = joints[k].bodies[0];
    s.span<uint32_t>(columns::joint_bodies)[2 * k + 1] = joints[k].bodies[1];
  }
  s.add({"counters", "1", S::u64, 1}, 1);
  s.add({"gravity", "m/s^2", S::f64, 3}, 1);
  s.add({"substep", "s", S::f64, 1}, 1);
  s.add({"push.id", "1", S::u64, 1}, 0);
  s.add({"push.force", "N", S::f64, 3}, 0);
  s.add({"push.at", "m", S::f64, 3}, 0);
  s.add({"push.remaining", "s", S::f64, 1}, 0);
  s.add({"drag.id", "1", S::u64, 1}, 0);
  s.add({"drag.target", "m", S::f64, 3}, 0);
  s.add({"drag.at", "m", S::f64, 3}, 0);
  s.add({"drag.stiffness", "N/m", S::f64, 1}, 0);
  for (State::Column c = 0; c < columns::per_body_end; ++c) s.reserve(c, bodies.starts.size());
  for (State::Column c = columns::contact_bodies; c < columns::contacts_end; ++c) {
    s.reserve(c, 4 * bodies.starts.size());
  }
  store3(s.f64(columns::gravity).data(), 0, gravity);
  for (const BodyStart& b : bodies.starts) append_body(s, b);
  return s;
}

void append_body(State& s, const BodyStart& b) {
  const size_t n = s.rows(columns::position);
  for (State::Column c = 0; c < columns::per_body_end; ++c) s.resize(c, n + 1);
  store3(s.f64(columns::position).data(), n, b.pose.position);
  store_quat(s.f64(columns::orientation).data(), n, b.pose.orientation);
  store3(s.f64(columns::velocity).data(), n, b.velocity);
  store3(s.f64(columns::angular_velocity).data(), n, b.angular_velocity);
  s.span<uint32_t>(columns::kind)[n] = b.kind;
  s.span<uint32_t>(columns::asleep)[n] = b.asleep;
  s.span<uint64_t>(columns::id)[n] = s.span<uint64_t>(columns::counters)[0]++;
}

std::optional<size_t> row_of_body(const State& s, uint64_t id) {
  const auto ids = s.span<uint64_t>(columns::id);
  const auto at = std::lower_bound(ids.begin(), ids.end(), id);
  if (at == ids.end() || *at != id) return std::nullopt;
  return static_cast<size_t>(at - ids.begin());
}

void wake_body(State& s, size_t row, std::span<const BodyKind> kinds) {
  const auto asleep = s.span<uint32_t>(columns::asleep);
  const auto kind = s.span<uint32_t>(columns::kind);
  s.f64(columns::sleep_timer)[row] = 0;
  if (!asleep[row]) return;
  std::vector<uint32_t> parent(asleep.size());
  start_islands(parent);
  const auto link = [&](uint32_t a, uint32_t b) {
    if (kinds[kind[a]].moved_by_forces() && kinds[kind[b]].moved_by_forces()) link_islands(parent, a, b);
  };
  const auto pairs = s.span<uint32_t>(columns::contact_bodies),
             joined = s.span<uint32_t>(columns::joint_bodies);
  for (size_t k = 0; k < pairs.size(); k += 2) link(pairs[k], pairs[k + 1]);
  for (size_t k = 0; k < joined.size(); k += 2) {
    const uint32_t a = joined[k], b = joined[k + 1];
    if (a != kNoBody && b != kNoBody && !s.span<uint32_t>(columns::joint_broken)[k / 2]) link(a, b);
  }
  const uint32_t island = island_of(parent, static_cast<uint32_t>(row));
  for (uint32_t i = 0; i < asleep.size(); ++i) {
    if (asleep[i] && island_of(parent, i) == island) asleep[i] = 0, s.f64(columns::sleep_timer)[i] = 0;
  }
}

namespace {

/// Removes row `gone` from a column.
template <class T>
void erase_row(State& s, State::Column c, size_t gone) {
  const size_t width = s.info(c).width, rows = s.rows(c);
  const auto all = s.span<T>(c);
  std::copy(all.begin() + static_cast<ptrdiff_t>((gone + 1) * width), all.end(),
            all.begin() + static_cast<ptrdiff_t>(gone * width));
  s.resize(c, rows - 1);
}

void erase_any_row(State& s, State::Column c, size_t gone) {
  switch (s.info(c).type) {
    case Scalar::f64:
      return erase_row<double>(s, c, gone);
    case Scalar::u32:
      return erase_row<uint32_t>(s, c, gone);
    case Scalar::u64:
      return erase_row<uint64_t>(s, c, gone);
    case Scalar::f32:
    case Scalar::i32:
      return;  // none of these here
  }
}

}  // namespace

void remove_body(State& s, size_t row) {
  const uint64_t id = s.span<uint64_t>(columns::id)[row];
  for (size_t k = s.rows(columns::contact_bodies); k-- > 0;) {
    const auto pair = s.span<uint32_t>(columns::contact_bodies);
    if (pair[2 * k] != row && pair[2 * k + 1] != row) continue;
    for (State::Column c = columns::contact_bodies; c < columns::contacts_end; ++c) erase_any_row(s, c, k);
  }
  for (uint32_t& b : s.span<uint32_t>(columns::contact_bodies)) b -= b > row;
  const auto joined = s.span<uint32_t>(columns::joint_bodies);
  for (size_t k = 0; k < joined.size(); ++k) {
    if (joined[k] == row) {
      s.span<uint32_t>(columns::joint_broken)[k / 2] = 1, joined[k] = kNoBody;
    } else if (joined[k] != kNoBody && joined[k] > row) {
      --joined[k];
    }
  }
  for (State::Column c = 0; c < columns::per_body_end; ++c) erase_any_row(s, c, row);
  columns::kHands.forget(s, id);
}

}  // namespace truestep::rigid3d
