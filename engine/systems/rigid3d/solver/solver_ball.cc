#include "engine/systems/rigid3d/solver/solver_ball.h"

#include <algorithm>

namespace truestep::rigid3d {

namespace {

bool only_a_ball(const Joint& j) {
  constexpr std::array<uint8_t, 6> kBall{1, 1, 1, 0, 0, 0};
  return j.form == Joint::Form::free && j.locked == kBall && j.drives == 0;
}

/// Axes along which the state stores the impulses of a joint.
void slide_axes(const Joint& j, const Rotation& a, Vec3 out[3]) {
  const Quat& q = j.slide_frame;
  const Rotation r = q.x == 0 && q.y == 0 && q.z == 0 ? a : a * rotation(q);
  for (int e = 0; e < 3; ++e) out[e] = axis(r, e);
}

}  // namespace

template <class T>
void BallSolver<T>::take(std::vector<uint32_t>& listed, const State& s, std::span<const Joint> joints,
                         std::span<const BodyNow> now) {
  const auto held = s.span<uint32_t>(columns::joint_bodies);
  const auto driven = [&](uint32_t i) { return i != kNoBody && now[i].part == BodyNow::Part::kinematic; };
  listed_.clear();
  std::erase_if(listed, [&](uint32_t k) {
    if (!only_a_ball(joints[k]) || driven(held[2 * k]) || driven(held[2 * k + 1])) return false;
    listed_.push_back(k);
    return true;
  });
}

template <class T>
void BallSolver<T>::fill(const State& s, std::span<const Joint> joints, const Bodies& bodies, double h,
                         const ThreadTeam& team) {
  const SoftConstraint<double> soft = JointSolver<T>::softness(h);
  pass_ = {T(soft.bias_rate), T(soft.mass_scale), T(soft.impulse_scale), T(1 / h)};
  lanes_.count = 0, lanes_.colour_begin.assign(1, 0);
  if (listed_.empty()) return;
  end_ = static_cast<uint32_t>(bodies.moving);
  moved_.assign(bodies.moving + 1, {});
  unscaled_.resize(bodies.moving);
  for (size_t i = 0; i < bodies.moving; ++i) {
    unscaled_[i].root = T(bodies.scaled[i].root);
    for (int e = 0; e < 9; ++e) unscaled_[i].turn[e] = T(bodies.scaled[i].turn[e]);
  }
  ends_.clear();
  const auto held = s.span<uint32_t>(columns::joint_bodies);
  const auto slot = [&](uint32_t i) { return i == kNoBody ? kNoBody : bodies.slot[i]; };
  for (const uint32_t k : listed_) ends_.push_back({slot(held[2 * k]), slot(held[2 * k + 1])});
  make_lanes(listed_, ends_, {}, bodies.moving, W::kLanes, colouring_, lanes_);
  if (groups_.size() < lanes_.count) groups_.resize(lanes_.count);
  team.for_blocks(lanes_.count, kGroupsPerBlock, [&](size_t begin, size_t end) {
    for (size_t g = begin; g < end; ++g) fill_group(g, s, joints, bodies, h);
  });
}

template <class T>
void BallSolver<T>::fill_group(size_t group, const State& s, std::span<const Joint> joints,
                               const Bodies& bodies, double h) {
  const auto held = s.span<uint32_t>(columns::joint_bodies);
  const double *impulse = s.f64(columns::joint_impulse).data(), *w = s.f64(columns::angular_velocity).data();
  BallGroup<T>& g = groups_[group] = BallGroup<T>{};
  for (int lane = 0; lane < W::kLanes; ++lane) {
    const uint32_t k = lanes_.member[group * W::kLanes + static_cast<size_t>(lane)];
    g.a[lane] = g.b[lane] = end_;
    if (k == kNoBody) continue;
    const auto body = [&](uint32_t i, const Vec3& anchor, uint32_t* slot, W& root, W arm[3], W spin[3][3]) {
      const Transform at = i == kNoBody ? transform_of(Pose{}) : bodies.now[i].at;
      const Vec3 r = at.direction(anchor);
      set3(arm, lane, r);
      if (i == kNoBody || bodies.slot[i] == kNoBody) return at.position + r;
      const ScaledBody& scaled = bodies.scaled[bodies.slot[i]];
      slot[lane] = bodies.slot[i], root.set(lane, T(scaled.root));
      for (int j = 0; j < 3; ++j) {
        const double* t = scaled.turn + 3 * j;
        set3(spin[j], lane, cross(Vec3{t[0], t[1], t[2]}, r));
      }
      return at.position + r;
    };
    const uint32_t a = held[2 * k], b = held[2 * k + 1];
    const Vec3 on_a = body(a, joints[k].anchor_a, g.a, g.root_a, g.arm_a, g.spin_a);
    const Vec3 on_b = body(b, joints[k].anchor_b, g.b, g.root_b, g.arm_b, g.spin_b);
    set3(g.gap, lane, on_b - on_a);
    const auto bend = [&](uint32_t i, const Vec3& anchor) {
      if (i == kNoBody || bodies.slot[i] == kNoBody) return Vec3{};
      const Vec3 t = load3(w, i) * h;
      return cross(t, cross(t, bodies.now[i].at.direction(anchor))) * 0.5;
    };
    set3(g.bend, lane, bend(b, joints[k].anchor_b) - bend(a, joints[k].anchor_a));
    Vec3 axes[3];
    slide_axes(joints[k], a == kNoBody ? Rotation{} : bodies.now[a].at.rotation, axes);
    const double* f = impulse + 6 * static_cast<size_t>(k);
    set3(g.impulse, lane, axes[0] * f[0] + axes[1] * f[1] + axes[2] * f[2]);
    g.strength.set(lane, 1);
  }
  detail::invert_ball(g);
}

template <class T>
void BallSolver<T>::start(Record8<T>* warm, const ThreadTeam& team) {
  each_colour(lanes_, groups_, team, [&](BallGroup<T>& g) { apply_balls(g, warm, end_); });
}

template <class T>
void BallSolver<T>::renew(const Record8<T>* moved, Record8<T>* warm, Renewal renewal,
                          const ThreadTeam& team) {
  if (lanes_.count == 0) return;
  for (size_t i = 0; i < end_; ++i) {
    const T *m = moved[i].x, *s = unscaled_[i].turn;
    T* out = moved_[i].x;
    for (int e = 0; e < 3; ++e) {
      out[e] = unscaled_[i].root * m[e], out[3 + e] = s[e] * m[3] + s[3 + e] * m[4] + s[6 + e] * m[5];
    }
  }
  each_colour(lanes_, groups_, team, [&](BallGroup<T>& g) {
    if (renewal == Renewal::last) {
      renew_balls<Renewal::last>(g, moved_.data(), warm, end_);
    } else {
      renew_balls<Renewal::goes_on>(g, moved_.data(), warm, end_);
    }
  });
}

template <class T>
void BallSolver<T>::bias(Record8<T>* v, const ThreadTeam& team) {
  each_colour(lanes_, groups_, team,
              [&](BallGroup<T>& g) { solve_balls<ContactSolve::bias>(g, v, end_, pass_); });
}

template <class T>
void BallSolver<T>::relax(Record8<T>* v, const ThreadTeam& team) {
  each_colour(lanes_, groups_, team,
              [&](BallGroup<T>& g) { solve_balls<ContactSolve::relax>(g, v, end_, relax_); });
}

template <class T>
void BallSolver<T>::store(State& s, std::span<const Joint> joints, double h) const {
  const auto impulse = s.f64(columns::joint_impulse), load = s.f64(columns::joint_load);
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  const auto held = s.span<uint32_t>(columns::joint_bodies);
  const double* q = s.f64(columns::orientation).data();
  for (size_t group = 0; group < lanes_.count; ++group) {
    const BallGroup<T>& g = groups_[group];
    for (int lane = 0; lane < W::kLanes; ++lane) {
      const uint32_t k = lanes_.member[group * W::kLanes + static_cast<size_t>(lane)];
      if (k == kNoBody) continue;
      const Vec3 f{double(g.impulse[0][lane]), double(g.impulse[1][lane]), double(g.impulse[2][lane])};
      const uint32_t a = held[2 * k];
      Vec3 axes[3];
      slide_axes(joints[k], a == kNoBody ? Rotation{} : rotation(load_quat(q, a)), axes);
      for (int e = 0; e < 3; ++e) impulse[6 * static_cast<size_t>(k) + e] = dot(axes[e], f);
      const Vec3 force = f / h;
      store3(load.data(), 2 * static_cast<size_t>(k), force);
      store3(load.data(), 2 * static_cast<size_t>(k) + 1, Vec3{});
      if (joints[k].break_force < kUnbounded && norm(force) > joints[k].break_force) broken[k] = 1;
    }
  }
}

template class BallSolver<float>;
template class BallSolver<double>;

}  // namespace truestep::rigid3d
