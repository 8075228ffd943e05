#include "engine/systems/rigid3d/solver_joint.h"

namespace truestep {

namespace columns = rigid3d_columns;

namespace {
/// Joints are springs of this share of the substeps' rate, damped that many times the critical.
constexpr double kJointHertzShare = 0.25, kJointDamping = 2;
}  // namespace

template <class T>
void JointSolver<T>::choose(const State& s, std::span<const BodyNow> now, std::span<uint32_t> slot) {
  const auto bodies = s.span<uint32_t>(columns::joint_bodies);
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  const auto active = [&](uint32_t i) { return i != kNoBody && now[i].part == BodyNow::Part::active; };
  listed_.clear();
  for (uint32_t k = 0; k < broken.size(); ++k) {
    const uint32_t a = bodies[2 * k], b = bodies[2 * k + 1];
    if (broken[k] || (!active(a) && !active(b))) continue;
    if (active(a)) slot[a] = 0;
    if (active(b)) slot[b] = 0;
    listed_.push_back(k);
  }
}

template <class T>
void JointSolver<T>::fill(const State& s, std::span<const Joint> joints, const Bodies& bodies,
                          const ThreadArena& arena) {
  end_ = static_cast<uint32_t>(bodies.moving);
  ends_.clear();
  const auto held = s.span<uint32_t>(columns::joint_bodies);
  const auto slot = [&](uint32_t i) { return i == kNoBody ? kNoBody : bodies.slot[i]; };
  for (const uint32_t k : listed_) ends_.push_back({slot(held[2 * k]), slot(held[2 * k + 1])});
  make_lanes(listed_, ends_, bodies.moving, W::kLanes, colouring_, lanes_);
  if (groups_.size() < lanes_.count) groups_.resize(lanes_.count);
  arena.for_blocks(lanes_.count, kGroupsPerBlock, [&](size_t begin, size_t end) {
    for (size_t g = begin; g < end; ++g) fill_group(g, s, joints, bodies);
  });
}

template <class T>
void JointSolver<T>::fill_group(size_t group, const State& s, std::span<const Joint> joints,
                                const Bodies& bodies) {
  const auto held = s.span<uint32_t>(columns::joint_bodies);
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  JointGroup<T>& g = groups_[group] = JointGroup<T>{};
  for (int lane = 0; lane < W::kLanes; ++lane) {
    const uint32_t k = lanes_.member[group * W::kLanes + lane];
    g.a[lane] = g.b[lane] = end_;
    if (k == kNoBody) continue;
    const uint32_t a = held[2 * k], b = held[2 * k + 1];
    const auto pose = [&](uint32_t i) { return i == kNoBody ? Pose{} : Pose{load3(x, i), load_quat(q, i)}; };
    const JointPlace at = joint_place(joints[k], pose(a), pose(b));
    const auto body = [&](uint32_t i, uint32_t* slot, W& root, W turn[9]) {
      if (i == kNoBody || bodies.slot[i] == kNoBody) return;
      const ScaledBody& scaled = bodies.scaled[bodies.slot[i]];
      slot[lane] = bodies.slot[i], root.set(lane, T(scaled.root));
      for (int e = 0; e < 9; ++e) turn[e].set(lane, T(scaled.turn[e]));
    };
    body(a, g.a, g.root_a, g.turn_a), body(b, g.b, g.root_b, g.turn_b);
    set3(g.arm_a, lane, at.arm_a), set3(g.arm_b, lane, at.arm_b), set3(g.error, lane, at.gap);
    for (int e = 0; e < 3; ++e) {
      set3(g.axis[e], lane, at.axes[e]);
      g.angle[e].set(lane, T(dot(at.axes[e], at.turn)));
    }
    for (int e = 0; e < 6; ++e) {
      g.locked[e].set(lane, T(joints[k].locked[e]));
      g.impulse[e].set(lane, T(s.f64(columns::joint_impulse)[6 * k + e]));
    }
  }
}

template <class T>
void JointSolver<T>::start(const Record8<T>* moved, Record8<T>* warm, double h, const ThreadArena& arena) {
  soft_ = soft_constraint<double>(kJointHertzShare / h, kJointDamping, h);
  each_colour(lanes_, groups_, arena, [&](JointGroup<T>& g) {
    prepare_joints(g, moved);
    apply_joints(g, warm, end_, T(1));
  });
}

template <class T>
void JointSolver<T>::renew(const Record8<T>* moved, Record8<T>* warm, const ThreadArena& arena) {
  each_colour(lanes_, groups_, arena, [&](JointGroup<T>& g) {
    apply_joints(g, warm, end_, T(-1));
    prepare_joints(g, moved);
    apply_joints(g, warm, end_, T(1));
  });
}

template <class T>
void JointSolver<T>::push(Record8<T>* v, const ThreadArena& arena) {
  each_colour(lanes_, groups_, arena, [&](JointGroup<T>& g) {
    solve_joints<ContactSolve::push>(g, v, end_, T(soft_.bias_rate), T(soft_.mass_scale),
                                     T(soft_.impulse_scale));
  });
}

template <class T>
void JointSolver<T>::relax(Record8<T>* v, const ThreadArena& arena) {
  each_colour(lanes_, groups_, arena,
              [&](JointGroup<T>& g) { solve_joints<ContactSolve::relax>(g, v, end_, T(0), T(1), T(0)); });
}

template <class T>
void JointSolver<T>::store(State& s, std::span<const Joint> joints, double h) const {
  const auto impulse = s.f64(columns::joint_impulse);
  for (size_t g = 0; g < lanes_.count; ++g) {
    for (int lane = 0; lane < W::kLanes; ++lane) {
      const uint32_t k = lanes_.member[g * W::kLanes + lane];
      if (k == kNoBody) continue;
      for (int e = 0; e < 6; ++e) impulse[6 * k + e] = groups_[g].impulse[e][lane];
      const Vec3 force = load3(impulse.data() + 6 * k, 0) / h;
      if (norm(force) > joints[k].break_force) s.span<uint32_t>(columns::joint_broken)[k] = 1;
    }
  }
}

template class JointSolver<float>;
template class JointSolver<double>;

}  // namespace truestep
