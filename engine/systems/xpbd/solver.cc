#include "engine/systems/xpbd/solver.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "engine/kernels/chebyshev.h"
#include "engine/kernels/springs/air.h"
#include "engine/kernels/xpbd/dihedral.h"
#include "engine/kernels/xpbd/linear.h"
#include "engine/kernels/xpbd/neo_hookean.h"
#include "engine/kernels/xpbd/volume.h"

namespace truestep::xpbd {

using Columns = XpbdColumns;

namespace {

// Most substeps that tension, and what pushes points out of solids, may ask for in a step, and the largest q
// allowed: 2 is the limit of stability. A rope that breaks up has gained energy; a push that is too long has
// only put a point where it belongs.
constexpr int kMostSubsteps = 10000, kMostByContact = 1000;
constexpr double kMostQ = 0.5;

}  // namespace

template <class T>
void Solver<T>::store(const SolverInput&, State& s, const StepInput& in) const {
  const auto x = s.f64(Columns::position), v = s.f64(Columns::velocity);
  const auto w = std::as_const(s).f64(Columns::inverse_mass);
  in.arena.for_blocks(w.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      // Held points keep their position to the bit.
      if (!(w[i] > 0)) continue;
      for (size_t k = 0; k < 3; ++k) {
        x[3 * i + k] += rows_[4 * i + k], v[3 * i + k] = velocity_[4 * i + k];
      }
    }
  });
}

template <class T>
void Solver<T>::weigh(const State& s, const StepInput& in, double h) {
  const double viscous = h * s.f64(Columns::damping)[0];
  const auto w = s.f64(Columns::inverse_mass);
  in.arena.for_blocks(w.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) rows_[4 * i + 3] = static_cast<T>(w[i] / (1 + viscous * w[i]));
  });
}

template <class T>
void Solver<T>::blow(const SolverInput& what, const State& s, const StepInput& in, double t, double h) {
  const AirOptions& air = what.air->options();
  const Vec3 wind = air::gusty(load3(s.f64(Columns::wind).data(), 0), air.gust, air.gust_period, t);
  const AirRows<T> on{s.f64(Columns::position).data(), rows_.data(), velocity_.data()};
  what.air->blow(wind, load3(s.f64(Columns::gravity).data(), 0), h, on, what.tears ? &torn_faces_ : nullptr,
                 blows_, in.arena);
}

template <class T>
void Solver<T>::predict(const SolverInput& what, const State& s, const StepInput& in, double h) {
  const Vec3 g = load3(s.f64(Columns::gravity).data(), 0);
  const T step = static_cast<T>(h), viscous = static_cast<T>(h * s.f64(Columns::damping)[0]);
  const T dv[4] = {static_cast<T>(h * g.x), static_cast<T>(h * g.y), static_cast<T>(h * g.z), T(0)};
  const double* w = s.f64(Columns::inverse_mass).data();
  for (size_t k = 0; k < Columns::kHands.pushes(s); ++k) {
    const UserForces::Push push = Columns::kHands.push(s, k);
    const Vec3 by = push.force * (h * w[push.who]);
    T* v = velocity_.data() + 4 * push.who;
    v[0] += static_cast<T>(by.x), v[1] += static_cast<T>(by.y), v[2] += static_cast<T>(by.z);
  }
  in.arena.for_blocks(points_, kBlockRows, [&](size_t begin, size_t end) {
    T *rows = rows_.data(), *before = before_.data(), *velocity = velocity_.data();
    for (size_t i = begin; i < end; ++i) {
      const T weight = rows[4 * i + 3];
      // A held point stays.
      const T keep = weight > 0 ? 1 - viscous * weight : T(0);
      for (size_t k = 0; k < 4; ++k) {
        before[4 * i + k] = rows[4 * i + k];
        velocity[4 * i + k] = keep * (velocity[4 * i + k] + dv[k]);
        rows[4 * i + k] += step * velocity[4 * i + k];
      }
    }
  });
}

template <class T>
void Solver<T>::hold_drags(const State& s, double h) {
  for (size_t k = 0; k < Columns::kHands.drags(s); ++k) {
    const UserForces::Drag drag = Columns::kHands.drag(s, k);
    T* row = rows_.data() + 4 * drag.who;
    const double w = row[3], share = w / (w + 1 / (drag.stiffness * h * h));
    const Vec3 to = drag.target - load3(s.f64(Columns::position).data(), drag.who);
    const double target[3] = {to.x, to.y, to.z};
    for (size_t i = 0; i < 3; ++i) row[i] = static_cast<T>(row[i] + share * (target[i] - row[i]));
  }
}

template <class T>
double Solver<T>::solve_chain_colours(const SolverInput& what, const StepInput& in, double h) {
  const ChainSchedule& chains = what.schedule.chains;
  const auto lanes = static_cast<size_t>(what.schedule.lanes);
  const PerStep<T> per = per_step<T>(h);
  for (const Colour& colour : chains.colours) {
    const size_t task = std::max<size_t>(1, kTaskLinks / (lanes * colour.longest));
    in.arena.for_blocks(colour.end - colour.begin, task, [&](size_t begin, size_t end) {
      ChainRow<T> near[kShortChain];
      for (size_t b = colour.begin + begin; b < colour.begin + end; ++b) {
        const ChainBatch& batch = chains.batches[b];
        const Chains<T> c{batch.links,
                          chains.points.data() + batch.first_point,
                          rest_.data() + batch.first_link,
                          compliance_.data() + batch.first_link,
                          damped_ ? damping_.data() + batch.first_link : nullptr,
                          lambda_of(lambda_, batch.first_link),
                          base_.data() + 3 * batch.first_link};
        ChainRow<T>* scratch = batch.links <= kShortChain ? near : scratch_.data() + batch.first_link / lanes;
        q_[b] = solve_chains(c, per, before_.data(), relax_, rows_.data(), scratch);
      }
    });
  }
  return q_.empty() ? 0 : *std::max_element(q_.begin(), q_.end());
}

template <class T>
double Solver<T>::iterate(const SolverInput& what, const State& s, const StepInput& in, double h) {
  const Schedule& schedule = what.schedule;
  const auto lanes = static_cast<size_t>(schedule.lanes);
  const PerStep<T> per = per_step<T>(h);
  T* rows = rows_.data();
  double q = 0;
  if (keeps_) {
    for (Column<T>* lambda : {&lambda_, &rods_.lambda, &hinges_.lambda, &volumes_.lambda, &sheet_.lambda}) {
      std::fill(lambda->begin(), lambda->end(), T(0));
    }
  }
  std::fill(angle_lambda_.begin(), angle_lambda_.end(), 0);
  cosserat_.forget_multipliers();
  strands_.forget_multipliers();
  matcher_.forget_multipliers();
  jacobi_.forget_multipliers();
  const bool accelerated = what.options.sweep == Sweep::chebyshev;
  const double radius =
      accelerated ? std::min(chebyshev_radius(what.options.iterations), jacobi_.radius(per)) : 0;
  double omega = 1;
  const double bending = stiffness_of(s.f64(Columns::stiffness), Family::bending);
  for (int k = 0; k < what.options.iterations; ++k) {
    each_batch(schedule.rods, in, [&](size_t b) {
      solve_linear<T, 3>({schedule.rods.points.data() + 3 * lanes * b, rods_.k.data() + 3 * lanes * b,
                          rods_.compliance.data() + lanes * b, lambda_of(rods_.lambda, 3 * lanes * b),
                          rods_.base.data() + 3 * lanes * b},
                         per, relax_, rows);
    });
    each_batch(schedule.hinges, in, [&](size_t b) {
      solve_linear<T, 4>({schedule.hinges.points.data() + 4 * lanes * b, hinges_.k.data() + 4 * lanes * b,
                          hinges_.compliance.data() + lanes * b, lambda_of(hinges_.lambda, 3 * lanes * b),
                          hinges_.base.data() + 3 * lanes * b},
                         per, relax_, rows);
    });
    each_batch(schedule.angles, in, [&](size_t b) {
      if (angle_torn_[b]) return;
      const AngleBend& bend = what.body.angles[schedule.angles.member[b]];
      const double alpha = compliance(bending * bend.factor) / (h * h);
      solve_dihedral<T>(bend.points, bend.rest, {alpha, 0}, relax_, s.f64(Columns::position).data(), rows,
                        angle_lambda_[b]);
    });
    each_batch(schedule.volumes, in, [&](size_t b) {
      if (what.options.poisson_ratio) {
        const T ratio = static_cast<T>(1 - 2 * *what.options.poisson_ratio);
        solve_neo_hookean<T>(
            {schedule.volumes.points.data() + 4 * lanes * b, volumes_.k.data() + 9 * lanes * b,
             volumes_.compliance.data() + lanes * b, ratio, lambda_of(volumes_.lambda, 2 * lanes * b),
             volumes_.base.data() + 9 * lanes * b},
            per, rows);
        return;
      }
      solve_volumes<T>({schedule.volumes.points.data() + 4 * lanes * b, volumes_.rest.data() + lanes * b,
                        volumes_.compliance.data() + lanes * b, lambda_of(volumes_.lambda, lanes * b),
                        volumes_.base.data() + 9 * lanes * b},
                       per, relax_, rows);
    });
    if (!what.matches.empty()) {
      matcher_.solve(what.matches, s.f64(Columns::position).data(), h, relax_, rows, in.arena);
    }
    if (k == 0) hold_drags(s, h);
    const T strands = what.tears ? strands_.solve(per, before_.data(), relax_, rows, in.arena) : T(0);
    q = std::max<double>({strands, solve_chain_colours(what, in, h), solve_sheet(what, in, h)});
    if constexpr (std::is_same_v<T, double>) {
      if (!what.rods.empty()) q = std::max(q, cosserat_.solve(what.rods, h, rows, in.arena));
    }
    if (!jacobi_.empty()) {
      omega = chebyshev_weight(k, radius, omega);
      q = std::max<double>(q, jacobi_.iterate(per, static_cast<T>(omega), relax_, rows, in.arena));
    }
    hold_tethers(what, s, in);
  }
  return q;
}

template <class T>
void Solver<T>::find_velocities(const SolverInput& what, const StepInput& in, double h) {
  const T per_h = static_cast<T>(1 / h);
  in.arena.for_blocks(4 * points_, 4 * kBlockRows, [&](size_t begin, size_t end) {
    const T *rows = rows_.data(), *before = before_.data();
    T* velocity = velocity_.data();
    for (size_t k = begin; k < end; ++k) velocity[k] = (rows[k] - before[k]) * per_h;
  });
}

template <class T>
void Solver<T>::remember_velocities(const StepInput& in) {
  in.arena.for_blocks(points_, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (size_t k = 0; k < 3; ++k) v_old_[3 * i + k] = velocity_[4 * i + k];
    }
  });
}

template <class T>
void Solver<T>::unpack(const SolverInput& what, const State& s, const StepInput& in) {
  const double* start = s.f64(Columns::position).data();
  in.arena.for_blocks(points_, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (size_t k = 0; k < 3; ++k) {
        x_old_[3 * i + k] = start[3 * i + k] + before_[4 * i + k];
        x_[3 * i + k] = start[3 * i + k] + rows_[4 * i + k];
      }
      w_[i] = rows_[4 * i + 3];
    }
  });
}

template <class T>
double Solver<T>::meet_self(const SolverInput& what, const State& s, const StepInput& in, double h) {
  const double* start = s.f64(Columns::position).data();
  unpack(what, s, in);
  if (!self_.resolve(folds(what), what.options.self, {x_old_, x_, w_, h}, in.arena)) return 0;
  double most = 0;
  for (size_t i = 0; i < points_; ++i) {
    if (!self_.moved(i)) continue;
    const Vec3 sought{rows_[4 * i], rows_[4 * i + 1], rows_[4 * i + 2]};
    const Vec3 now = load3(x_.data(), i) - load3(start, i), by = now - sought, dv = by / h;
    most = std::max(most, norm2(by));
    T *row = rows_.data() + 4 * i, *v = velocity_.data() + 4 * i;
    row[0] = static_cast<T>(now.x), row[1] = static_cast<T>(now.y), row[2] = static_cast<T>(now.z);
    v[0] += static_cast<T>(dv.x), v[1] += static_cast<T>(dv.y), v[2] += static_cast<T>(dv.z);
  }
  return std::sqrt(most);
}

template <class T>
double Solver<T>::collide(const SolverInput& what, const State& s, const StepInput& in, double t, double h) {
  const double* start = s.f64(Columns::position).data();
  const size_t n = points_;
  const T per_h = static_cast<T>(1 / h);
  unpack(what, s, in);
  in.arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (size_t k = 0; k < 3; ++k) v_[3 * i + k] = (rows_[4 * i + k] - before_[4 * i + k]) * per_h;
    }
  });
  const auto now = [n](std::vector<double>& column) { return std::span(column).first(3 * n); };
  ContactSweep sweep{t, h, now(x_old_), now(v_old_), now(x_), now(v_)};
  sweep.inverse_mass = std::span(w_).first(n), sweep.radius = what.options.radius,
  sweep.surfaces = what.surfaces;
  what.colliders.resolve(sweep, in.workspace, in.arena);
  in.arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    double most = 0;
    for (size_t i = begin; i < end; ++i) {
      const Vec3 sought{rows_[4 * i], rows_[4 * i + 1], rows_[4 * i + 2]};
      most = std::max(most, norm2(load3(x_.data(), i) - load3(start, i) - sought));
      for (size_t k = 0; k < 3; ++k) {
        rows_[4 * i + k] = static_cast<T>(x_[3 * i + k] - start[3 * i + k]);
        velocity_[4 * i + k] = static_cast<T>(v_[3 * i + k]);
      }
    }
    put_back_[begin / kBlockRows] = std::sqrt(most);
  });
  const auto blocks = static_cast<ptrdiff_t>((n + kBlockRows - 1) / kBlockRows);
  return *std::max_element(put_back_.begin(), put_back_.begin() + blocks);
}

/// Rods are solved in double precision only (xpbd_rod_def.cc).
template <class T>
void Solver<T>::step(const SolverInput& what, State& s, const StepInput& in) {
  constexpr bool kRods = std::is_same_v<T, double>;
  const SolverOptions& options = what.options;
  const double longest = in.h / options.substeps, shortest = in.h / kMostSubsteps;
  const double tightest_contact = kMostQ * kMostByContact * kMostByContact / (in.h * in.h);
  double& tightness = s.f64(Columns::tightness)[0];
  prepare(what, s);
  load(what, s, in);
  if (what.folds) self_.begin_step(folds(what));
  const bool rods = kRods && !what.rods.empty();
  int left = options.substeps;
  for (double done = 0; left > 0; --left) {
    const double rest = in.h - done;
    if (options.division == SolverOptions::Division::by_tension) {
      const double bearable = tightness > 0 ? std::sqrt(kMostQ / tightness) : longest;
      left = static_cast<int>(std::ceil(rest / std::clamp(bearable, shortest, longest) * (1 - 1e-9)));
    }
    const double h = rest / left;
    if (!what.colliders.empty()) remember_velocities(in);
    if (s.f64(Columns::damping)[0] > 0) weigh(s, in, h);
    if (what.air) blow(what, s, in, in.t + done, h);
    if constexpr (kRods) {
      if (rods)
        cosserat_.measure(what.rods, rows_.data(), in.arena), cosserat_.predict(what.rods, h, in.arena);
    }
    predict(what, s, in, h);
    const double q = iterate(what, s, in, h);
    double pushed = 0;
    if (rods) cosserat_.find_spins(what.rods, h, in.arena);
    if (what.colliders.empty()) {
      find_velocities(what, in, h);
    } else {
      pushed = collide(what, s, in, in.t + done, h) / options.shortest_link;
    }
    if (what.folds) pushed = std::max(pushed, meet_self(what, s, in, h) / options.shortest_link);
    // A cloth just pulled tight may be so again soon: one substep's value decays gradually.
    tightness = std::max({q / (h * h), std::min(pushed / (h * h), tightest_contact), 0.8 * tightness});
    done += h;
  }
  store(what, s, in);
  if (rods) cosserat_.store(what.rods, s);
}

template class Solver<float>;
template class Solver<double>;

}  // namespace truestep::xpbd
