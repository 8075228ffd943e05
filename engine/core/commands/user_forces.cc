#include "engine/core/commands/user_forces.h"

#include <array>

namespace truestep {

namespace {

uint64_t who_of(const State& s, State::Column c, size_t k) {
  return s.info(c).type == Scalar::u64 ? s.span<uint64_t>(c)[k] : s.span<uint32_t>(c)[k];
}

void set_who(State& s, State::Column c, size_t k, uint64_t who) {
  if (s.info(c).type == Scalar::u64) {
    s.span<uint64_t>(c)[k] = who;
  } else {
    s.span<uint32_t>(c)[k] = static_cast<uint32_t>(who);
  }
}

// Points have as many components as the system's space; a missing column means the centre of mass.
Vec3 place_of(const State& s, State::Column c, size_t k) {
  if (c == UserForces::kNone) return {};
  const auto at = s.f64(c);
  return s.info(c).width == 3 ? load3(at.data(), k) : Vec3{at[2 * k], at[2 * k + 1], 0};
}

void set_place(State& s, State::Column c, size_t k, const Vec3& p) {
  if (c == UserForces::kNone) return;
  const auto at = s.f64(c);
  if (s.info(c).width == 3) return store3(at.data(), k, p);
  at[2 * k] = p.x, at[2 * k + 1] = p.y;
}

template <size_t N>
size_t append(State& s, const std::array<State::Column, N>& columns) {
  const size_t k = s.rows(columns[0]);
  for (const State::Column c : columns) {
    if (c != UserForces::kNone) s.resize(c, k + 1);
  }
  return k;
}

/// In all columns, keeps the rows k with keep(k), in order.
template <size_t N, class Keep>
void keep_rows(State& s, const std::array<State::Column, N>& columns, const Keep& keep) {
  size_t kept = 0;
  for (size_t k = 0, n = s.rows(columns[0]); k < n; ++k) {
    if (!keep(k)) continue;
    for (const State::Column c : columns) {
      if (c != UserForces::kNone && kept < k) s.copy_row(c, k, kept);
    }
    ++kept;
  }
  for (const State::Column c : columns) {
    if (c != UserForces::kNone) s.resize(c, kept);
  }
}

std::array<State::Column, 4> all(const UserForces::PushColumns& c) {
  return {c.who, c.force, c.remaining, c.at};
}
std::array<State::Column, 5> all(const UserForces::DragColumns& c) {
  return {c.who, c.target, c.stiffness, c.at, c.impulse};
}

}  // namespace

void UserForces::add_push(State& s, const Push& p, double duration) const {
  const size_t k = append(s, all(push_));
  set_who(s, push_.who, k, p.who);
  store3(s.f64(push_.force).data(), k, p.force);
  set_place(s, push_.at, k, p.at);
  s.f64(push_.remaining)[k] = duration;
}

void UserForces::set_drag(State& s, uint64_t who, const Vec3& target, double stiffness,
                          std::optional<Vec3> at) const {
  size_t k = 0;
  while (k < drags(s) && who_of(s, drag_.who, k) != who) ++k;
  if (k == drags(s)) append(s, all(drag_));
  set_who(s, drag_.who, k, who);
  store3(s.f64(drag_.target).data(), k, target);
  s.f64(drag_.stiffness)[k] = stiffness;
  if (at) set_place(s, drag_.at, k, *at);
}

void UserForces::release(State& s, std::optional<uint64_t> who) const {
  keep_rows(s, all(drag_), [&](size_t k) { return who && who_of(s, drag_.who, k) != *who; });
}

void UserForces::forget(State& s, uint64_t who) const {
  keep_rows(s, all(push_), [&](size_t k) { return who_of(s, push_.who, k) != who; });
  release(s, who);
}

void UserForces::count_down(State& s, double h) const {
  if (pushes(s) == 0) return;
  const auto remaining = s.f64(push_.remaining);
  for (double& left : remaining) left -= h;
  keep_rows(s, all(push_), [&](size_t k) { return s.f64(push_.remaining)[k] >= 0.5 * h; });
}

void UserForces::check_pushes(StateCheck& check, uint64_t rows) const {
  if (push_.at == kNone) {
    check.together({push_.who, push_.force, push_.remaining});
  } else {
    check.together({push_.who, push_.force, push_.at, push_.remaining});
  }
  for (size_t k = 0; k < pushes(check.state()); ++k) {
    check.require(who_of(check.state(), push_.who, k) < rows, "the row of a push");
  }
}

UserForces::Push UserForces::push(const State& s, size_t k) const {
  return {who_of(s, push_.who, k), load3(s.f64(push_.force).data(), k), place_of(s, push_.at, k)};
}

UserForces::Drag UserForces::drag(const State& s, size_t k) const {
  return {who_of(s, drag_.who, k), load3(s.f64(drag_.target).data(), k), s.f64(drag_.stiffness)[k],
          place_of(s, drag_.at, k)};
}

}  // namespace truestep
