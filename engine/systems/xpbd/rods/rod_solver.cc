#include "engine/systems/xpbd/rods/rod_solver.h"

#include <algorithm>

#include "engine/systems/xpbd/solver.h"

namespace truestep::xpbd {

namespace {

Quat load4(const double* q, size_t i) {
  return {q[4 * i], q[4 * i + 1], q[4 * i + 2], q[4 * i + 3]};
}
void store4(double* q, size_t i, const Quat& a) {
  q[4 * i] = a.w, q[4 * i + 1] = a.x, q[4 * i + 2] = a.y, q[4 * i + 3] = a.z;
}

}  // namespace

void RodSolver::prepare(const RodSet& rods, size_t spare, bool keeps) {
  const size_t n = rods.links, count = batches(rods), spare_frame = rods.frames.size();
  points_.assign(count * (n + 1) * kLanes, static_cast<uint32_t>(spare));
  frames_of_.assign(count * (n + 2) * kLanes, static_cast<uint32_t>(spare_frame));
  base_.assign(count * n * 3 * kLanes, 0), per_length_.assign(count * n * kLanes, 1);
  joint_per_length_.assign(count * (n + 1) * kLanes, 1), rest_.assign(count * (n + 1) * 3 * kLanes, 0);
  stretch_.assign(count * n * 3 * kLanes, kIdle), bend_.assign(count * (n + 1) * 3 * kLanes, kIdle);
  strains_.assign(rods.damping_time > 0 ? count * (2 * n + 1) * 3 * kLanes : 0, 0);
  lambda_.assign(keeps ? count * (2 * n + 1) * 3 * kLanes : 0, 0);
  frames_.assign(4 * (spare_frame + 1), 0), frames_[4 * spare_frame] = 1;
  old_frames_ = frames_, spins_.assign(frames_.size(), 0), inverse_inertia_.assign(frames_.size(), 0);
  scratch_.resize(count * (n + 1)), q_.assign(count, 0);
  const Vec3 shear = rods.stretching(), bend = rods.bending();
  for (size_t r = 0; r < rods.rods; ++r) {
    const size_t b = r / kLanes, lane = r % kLanes;
    for (size_t j = 0; j <= n; ++j) {
      points_[(b * (n + 1) + j) * kLanes + lane] = static_cast<uint32_t>(rods.first_point(r) + j);
      const size_t at = (b * (n + 1) + j) * kLanes + lane, at3 = (b * (n + 1) + j) * 3 * kLanes + lane;
      const double l = rods.joint_length(r, j);
      joint_per_length_[at] = 1 / l;
      const Vec3& rest = rods.rest[rods.first_joint(r) + j];
      rest_[at3] = rest.x, rest_[at3 + kLanes] = rest.y, rest_[at3 + 2 * kLanes] = rest.z;
      bend_[at3] = 1 / (bend.x * l), bend_[at3 + kLanes] = 1 / (bend.y * l);
      bend_[at3 + 2 * kLanes] = 1 / (bend.z * l);
    }
    for (size_t j = 0; j < n + 2; ++j) {
      frames_of_[(b * (n + 2) + j) * kLanes + lane] = static_cast<uint32_t>(rods.first_frame(r) + j);
    }
    for (size_t j = 0; j < n; ++j) {
      const size_t at3 = (b * n + j) * 3 * kLanes + lane;
      const double l = rods.length[r * n + j];
      per_length_[(b * n + j) * kLanes + lane] = 1 / l;
      stretch_[at3] = 1 / (shear.x * l), stretch_[at3 + kLanes] = 1 / (shear.y * l);
      stretch_[at3 + 2 * kLanes] = 1 / (shear.z * l);
      const Vec3& i = rods.inertia[r * n + j];
      double* to = inverse_inertia_.data() + 4 * (rods.first_frame(r) + j + 1);
      to[0] = 1 / i.x, to[1] = 1 / i.y, to[2] = 1 / i.z;
    }
  }
}

void RodSolver::load(const RodSet& rods, const State& s) {
  const auto q = s.f64(rods.orientation), spin = s.f64(rods.spin);
  const auto w = s.f64(XpbdColumns::inverse_mass);
  const double* x = s.f64(XpbdColumns::position).data();
  std::copy(q.begin(), q.end(), frames_.begin());
  const size_t n = rods.links;
  const Vec3 bend = rods.bending();
  for (size_t r = 0; r < rods.rods; ++r) {
    const size_t b = r / kLanes, lane = r % kLanes;
    for (size_t i = 0; i < n + 2; ++i) {
      const size_t frame = rods.first_frame(r) + i;
      for (size_t k = 0; k < 3; ++k) spins_[4 * frame + k] = spin[3 * frame + k];
    }
    for (const size_t j : {size_t{0}, n}) {
      const bool holds = rods.holds(j, w[rods.first_point(r) + j]);
      const double l = rods.joint_length(r, j), k[3] = {bend.x * l, bend.y * l, bend.z * l};
      double* to = bend_.data() + (b * (n + 1) + j) * 3 * kLanes + lane;
      for (size_t i = 0; i < 3; ++i) to[i * kLanes] = holds ? 1 / k[i] : kIdle;
    }
    for (size_t j = 0; j < n; ++j) {
      const Vec3 d = load3(x, rods.first_point(r) + j + 1) - load3(x, rods.first_point(r) + j);
      double* to = base_.data() + (b * n + j) * 3 * kLanes + lane;
      to[0] = d.x, to[kLanes] = d.y, to[2 * kLanes] = d.z;
    }
  }
}

Rods<double> RodSolver::batch(const RodSet& rods, size_t b, double gamma) {
  const size_t n = rods.links;
  Rods<double> c;
  c.links = n;
  c.points = points_.data() + b * (n + 1) * kLanes, c.frames = frames_of_.data() + b * (n + 2) * kLanes;
  c.base = base_.data() + b * n * 3 * kLanes, c.per_length = per_length_.data() + b * n * kLanes;
  c.joint_per_length = joint_per_length_.data() + b * (n + 1) * kLanes;
  c.rest = rest_.data() + b * (n + 1) * 3 * kLanes, c.stretch = stretch_.data() + b * n * 3 * kLanes;
  c.bend = bend_.data() + b * (n + 1) * 3 * kLanes, c.inverse_inertia = inverse_inertia_.data();
  if (!strains_.empty()) c.before = strains_.data() + b * (2 * n + 1) * 3 * kLanes, c.gamma = gamma;
  if (!lambda_.empty()) c.lambda = lambda_.data() + b * (2 * n + 1) * 3 * kLanes;
  return c;
}

void RodSolver::predict(const RodSet& rods, double h, const ThreadArena& arena) {
  const size_t n = rods.links;
  arena.for_blocks(rods.rods, 64, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) {
      const size_t first = rods.first_frame(r), wall = first + n + 1;
      for (size_t i = first; i <= wall; ++i) {
        Quat q = load4(frames_.data(), i);
        store4(old_frames_.data(), i, q);
        if (i == first || i == wall) continue;
        store4(frames_.data(), i,
               turned_by(q, Vec3{spins_[4 * i], spins_[4 * i + 1], spins_[4 * i + 2]} * h));
      }
      if (rods.twist_rate != 0) {
        const Quat q = load4(frames_.data(), wall);
        store4(frames_.data(), wall, turned_by(q, Vec3{0, 0, rods.twist_rate * h}));
      }
    }
  });
}

void RodSolver::measure(const RodSet& rods, const double* rows, const ThreadArena& arena) {
  if (strains_.empty()) return;
  const size_t row = (2 * rods.links + 1) * 3 * kLanes;
  arena.for_blocks(batches(rods), 8, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      measure_rods(batch(rods, b, 0), rows, frames_.data(), strains_.data() + b * row);
    }
  });
}

void RodSolver::forget_multipliers() {
  std::fill(lambda_.begin(), lambda_.end(), 0.0);
}

double RodSolver::solve(const RodSet& rods, double h, double* rows, const ThreadArena& arena) {
  const PerStep<double> per = per_step<double>(h);
  const double gamma = rods.damping_time / h;
  arena.for_blocks(batches(rods), 8, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      q_[b] = solve_rods(batch(rods, b, gamma), per, rows, frames_.data(),
                         scratch_.data() + b * (rods.links + 1));
    }
  });
  return *std::max_element(q_.begin(), q_.end());
}

void RodSolver::find_spins(const RodSet& rods, double h, const ThreadArena& arena) {
  arena.for_blocks(rods.frames.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Quat p = turn_between(load4(old_frames_.data(), i), load4(frames_.data(), i));
      // No real motion turns by half a circle in a substep: the spin is kept finite.
      const double scale = 2 / (std::max(p.w, 1e-6) * h);
      spins_[4 * i] = p.x * scale, spins_[4 * i + 1] = p.y * scale, spins_[4 * i + 2] = p.z * scale;
    }
  });
}

void RodSolver::store(const RodSet& rods, State& s) const {
  const auto q = s.f64(rods.orientation), spin = s.f64(rods.spin);
  std::copy_n(frames_.begin(), q.size(), q.begin());
  for (size_t i = 0; i < rods.frames.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) spin[3 * i + k] = spins_[4 * i + k];
  }
}

}  // namespace truestep::xpbd
