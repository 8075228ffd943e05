// What commands do to a rigid2d state; errors name the member of the command that is wrong.
#include <algorithm>

#include "engine/core/command_checks.h"
#include "engine/systems/rigid2d/rigid2d.h"

namespace truestep::rigid2d {
namespace {

void store2(State& s, State::Column c, size_t k, Vec2 v) {
  s.f64(c)[2 * k] = v.x, s.f64(c)[2 * k + 1] = v.y;
}

void add_push(State& s, uint32_t body, Vec2 local, const Vec3& force, double duration) {
  const size_t k = s.rows(columns::push_body);
  for (const auto c : columns::kPushColumns) s.resize(c, k + 1);
  s.span<uint32_t>(columns::push_body)[k] = body;
  store2(s, columns::push_local, k, local);
  store3(s.f64(columns::push_force).data(), k, force);
  s.f64(columns::push_remaining)[k] = duration;
}

/// A drag that goes on keeps the point that it took hold of.
void set_drag(State& s, uint32_t body, std::optional<Vec2> local, const Vec3& target, double stiffness) {
  const auto bodies = s.span<uint32_t>(columns::drag_body);
  const auto k = static_cast<size_t>(std::find(bodies.begin(), bodies.end(), body) - bodies.begin());
  if (k == bodies.size()) {
    for (const auto c : columns::kDragColumns) s.resize(c, k + 1);
    store2(s, columns::drag_local, k, {});
  }
  s.span<uint32_t>(columns::drag_body)[k] = body;
  if (local) store2(s, columns::drag_local, k, *local);
  store3(s.f64(columns::drag_target).data(), k, target);
  s.f64(columns::drag_stiffness)[k] = stiffness;
}

void end_drag(State& s, std::optional<uint32_t> row) {
  size_t kept = 0;
  for (size_t k = 0; k < s.rows(columns::drag_body); ++k) {
    const auto rows = s.span<uint32_t>(columns::drag_body);
    const auto local = s.f64(columns::drag_local);
    if (!row || rows[k] == *row) continue;
    double* target = s.f64(columns::drag_target).data();
    const auto stiffness = s.f64(columns::drag_stiffness), impulse = s.f64(columns::drag_impulse);
    rows[kept] = rows[k], stiffness[kept] = stiffness[k];
    store3(target, kept, load3<double>(target, k));
    local[2 * kept] = local[2 * k], local[2 * kept + 1] = local[2 * k + 1];
    impulse[2 * kept] = impulse[2 * k], impulse[2 * kept + 1] = impulse[2 * k + 1];
    ++kept;
  }
  for (const auto c : columns::kDragColumns) s.resize(c, kept);
}

}  // namespace

void Rigid2d::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.value < 0) refuse_command("value", "out_of_range", "the value must be at least 0");
  const auto status = s.span<uint32_t>(columns::status);
  const auto row = [&] { return static_cast<uint32_t>(checked_command_row(c, model_.count(), "body")); };
  const auto dynamic = [&] {
    const uint32_t r = row();
    if (model_.bodies[r].motion != Motion::dynamic) {
      refuse_command("index", "not_dynamic", "the body of this row is not moved by forces");
    }
    return r;
  };
  // Where on the body, about its centre of mass in its own frame.
  const auto local = [&](uint32_t body) -> std::optional<Vec2> {
    if (!c.at) return std::nullopt;
    return pose_of(s, body).back(flat::flatten(*c.at));
  };
  // Those around a body that comes, goes or is held must not sleep on.
  const auto wake_neighbours = [&](uint32_t body) {
    std::vector<uint8_t> seeds(model_.count());
    for (const uint64_t key : s.span<uint64_t>(columns::contact_key)) {
      const uint32_t a = model_.body_of[key >> 32], b = model_.body_of[static_cast<uint32_t>(key)];
      if (a == body) seeds[b] = 1;
      if (b == body) seeds[a] = 1;
    }
    wake_islands(model_, s, seeds);
  };
  double* v = s.f64(columns::velocity).data();
  const auto w = s.f64(columns::angular_velocity);
  switch (c.kind) {
    case CommandKind::push: {
      const uint32_t r = dynamic();
      wake(s, r);
      return add_push(s, r, local(r).value_or(Vec2{}), c.vector, c.duration);
    }
    case CommandKind::impulse: {
      const uint32_t body = dynamic();
      const Body& b = model_.bodies[body];
      wake(s, body);
      if (!is_moved(model_.light[body], status[body])) return;
      v[3 * body] += b.inverse_mass * c.vector.x, v[3 * body + 1] += b.inverse_mass * c.vector.y;
      const Vec2 arm = pose_of(s, body).q * local(body).value_or(Vec2{});
      w[body] += b.inverse_inertia * flat::cross(arm, flat::flatten(c.vector));
      return;
    }
    case CommandKind::drag: {
      const uint32_t r = dynamic();
      // Without a stiffness of its own a drag pulls like a spring of three hertz.
      const double usual = 355 * model_.bodies[r].mass;
      wake(s, r);
      return set_drag(s, r, local(r), c.vector, c.value > 0 ? c.value : usual);
    }
    case CommandKind::release:
      return end_drag(s, c.index == -1 ? std::nullopt : std::optional(row()));
    case CommandKind::pin: {
      const uint32_t body = dynamic();
      wake(s, body);
      status[body] |= kPinned;
      v[3 * body] = v[3 * body + 1] = 0, w[body] = 0;
      return;
    }
    case CommandKind::unpin: {
      const uint32_t body = dynamic();
      status[body] = (status[body] & ~uint32_t{kPinned}) | kAwake;
      s.f64(columns::rest)[body] = 0;
      return wake_neighbours(body);
    }
    case CommandKind::remove: {
      const uint32_t body = row();
      for (const Joint& j : model_.joints) {
        if (j.a == body || j.b == body) {
          refuse_command("index", "joined", "a body that a joint holds cannot be removed");
        }
      }
      wake_neighbours(body);
      status[body] |= kRemoved;
      v[3 * body] = v[3 * body + 1] = 0, w[body] = 0;
      return;
    }
    case CommandKind::set_parameter:
      if (c.name != "gravity") {
        refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                       "gravity");
      }
      store3(s.f64(columns::parameters).data(), 0, c.vector);
      return (void)wake_islands(model_, s, std::vector<uint8_t>(model_.count(), 1));
    case CommandKind::spawn:
      break;
  }
  refuse_command("kind", "unsupported_command", "the bodies of this system are those of its scene",
                 "push, impulse, drag, release, pin, unpin, remove, set_parameter");
}

}  // namespace truestep::rigid2d
