// Packs lane by lane: constants of the constraints when a stiffness has changed, and their state at the start
// of a step.
#include <algorithm>
#include <tuple>

#include "engine/math/trig.h"
#include "engine/systems/xpbd/solver.h"

namespace truestep::xpbd {

using Columns = XpbdColumns;

template <class T>
void Solver<T>::resize(size_t entries, size_t points, size_t components, Set& out) {
  out.k.resize(points * entries), out.rest.resize(entries), out.compliance.resize(entries);
  out.lambda.resize(components * entries);
  out.base.resize((components == 3 ? 3 : 9) * entries);
}

template <class T>
template <class Bends, class Torn>
void Solver<T>::pack_bends(const SetSchedule& schedule, const Bends& bends, double stiffness,
                           const Torn& torn, Set& out) const {
  constexpr size_t kPoints = std::tuple_size_v<decltype(bends.front().points)>;
  constexpr auto kLanes = static_cast<size_t>(Wide<T>::kLanes);
  resize(schedule.member.size(), kPoints, 3, out);
  for (size_t e = 0; e < schedule.member.size(); ++e) {
    const uint32_t member = schedule.member[e];
    out.compliance[e] = member == kNobody ? T(0)
                        : torn(bends[member].points)
                            ? static_cast<T>(kIdle)
                            : static_cast<T>(compliance(stiffness * bends[member].factor));
    for (size_t i = 0; i < kPoints; ++i) {
      out.k[(e / kLanes * kPoints + i) * kLanes + e % kLanes] =
          member == kNobody ? T(0) : static_cast<T>(bends[member].k[i]);
    }
  }
}

template <class T>
void Solver<T>::pack_links(const SolverInput& what, const State& s) {
  const ChainSchedule& chains = what.schedule.chains;
  const size_t links = chains.link.size();
  const double damping = s.f64(Columns::damping)[1];
  rest_.assign(links, T(0)), compliance_.assign(links, static_cast<T>(kIdle));
  damping_.assign(damped_ ? links : 0, T(0)), lambda_.assign(keeps_ ? links : 0, T(0));
  for (size_t e = 0; e < links; ++e) {
    if (chains.link[e] == kNobody) continue;
    if (what.tears && !what.tears->whole(corners_, chains.link[e])) continue;
    const Link& l = what.body.links[chains.link[e]];
    const double k = stiffness_of(s.f64(Columns::stiffness), l.family) * l.factor;
    rest_[e] = static_cast<T>(l.rest), compliance_[e] = static_cast<T>(compliance(k));
    if (damped_ && k > 0) damping_[e] = static_cast<T>(damping / k);
  }
  base_.resize(3 * links);
  q_.resize(chains.batches.size());
  uint32_t longest = 0;
  for (const Colour& c : chains.colours) longest = std::max(longest, c.longest);
  scratch_.resize(longest > kShortChain ? links / Wide<T>::kLanes : 0);
}

template <class T>
void Solver<T>::pack_volumes(const SolverInput& what, const State& s) {
  const SetSchedule& schedule = what.schedule.volumes;
  constexpr auto kLanes = static_cast<size_t>(Wide<T>::kLanes);
  const double modulus = stiffness_of(s.f64(Columns::stiffness), Family::volume);
  const std::optional<double>& nu = what.options.poisson_ratio;
  resize(schedule.member.size(), 0, 1, volumes_);
  // For an elastic tetrahedron k holds the inverse of its edges, and there are two multipliers.
  volumes_.k.assign(nu ? 9 * schedule.member.size() : 0, T(0));
  volumes_.lambda.resize((nu ? 2 : 1) * schedule.member.size());
  for (size_t e = 0; e < schedule.member.size(); ++e) {
    const uint32_t member = schedule.member[e];
    const double rest = member == kNobody ? 1 : what.body.tetrahedra[member].rest;
    volumes_.rest[e] = static_cast<T>(rest);
    if (!nu) {
      volumes_.compliance[e] = static_cast<T>(compliance(modulus / rest));
      continue;
    }
    volumes_.compliance[e] = static_cast<T>(2 * (1 + *nu) / (modulus * rest));
    for (size_t i = 0; i < 9 && member != kNobody; ++i) {
      volumes_.k[9 * (e - e % kLanes) + i * kLanes + e % kLanes] =
          static_cast<T>(what.body.tetrahedra[member].inverse.m[i]);
    }
  }
}

template <class T>
bool Solver<T>::same_corners(const SolverInput& what, const State& s) {
  if (!what.tears) return true;
  const auto corners = s.span<uint32_t>(what.tears->columns.corner);
  if (std::equal(corners.begin(), corners.end(), corners_.begin(), corners_.end())) return true;
  corners_.assign(corners.begin(), corners.end());
  return false;
}

template <class T>
void Solver<T>::prepare(const SolverInput& what, const State& s) {
  const auto stiffness = s.f64(Columns::stiffness), damping = s.f64(Columns::damping);
  std::vector<double>& key = built_with_;
  const bool untorn = same_corners(what, s);
  const bool same = untorn && built_for_ == &what.schedule && key.size() == kFamilies + 1 &&
                    std::equal(stiffness.begin(), stiffness.end(), key.begin()) &&
                    key[kFamilies] == damping[1];
  if (same) return;
  built_for_ = &what.schedule;
  key.assign(stiffness.begin(), stiffness.end());
  key.push_back(damping[1]);

  const Schedule& schedule = what.schedule;
  const SolverOptions& options = what.options;
  soft_ = options.scheme == Scheme::xpbd;
  keeps_ = soft_ && options.iterations > 1;
  damped_ = soft_ && damping[1] > 0;
  relax_ = 1;
  if (!soft_ && options.projection < 1) {
    // n iterations leave (1 - k) of an error (Mueller et al. 2007, section 3.3).
    relax_ = static_cast<T>(1 - trig::pow(1 - options.projection, 1.0 / options.iterations));
  }
  // Rods have one row for their empty lanes.
  const size_t rows = schedule.rows + (what.rods.empty() ? 0 : 1);
  rows_.assign(4 * rows, T(0)), before_.assign(4 * rows, T(0)), velocity_.assign(4 * rows, T(0));
  if (!what.rods.empty()) cosserat_.prepare(what.rods, schedule.rows, keeps_);
  pack_links(what, s);
  const double bending = stiffness_of(stiffness, Family::bending);
  const auto torn = [&](const auto& points) {
    return what.tears && std::any_of(points.begin(), points.end(),
                                     [&](uint32_t p) { return what.tears->split(corners_, p); });
  };
  pack_bends(schedule.rods, what.body.rods, bending, torn, rods_);
  pack_bends(schedule.hinges, what.body.hinges, bending, torn, hinges_);
  angle_lambda_.resize(schedule.angles.member.size());
  angle_torn_.resize(angle_lambda_.size());
  for (size_t e = 0; e < angle_torn_.size(); ++e) {
    angle_torn_[e] = torn(what.body.angles[schedule.angles.member[e]].points);
  }
  if (what.tears && what.air) {
    torn_faces_.begin.reserve(what.body.capacity + 2);
    torn_faces_.build(corners_, s.rows(Columns::position));
  }
  if (what.tears && what.folds) {
    if (!torn_folds_) torn_folds_ = *what.folds;
    torn_folds_->follow_tears(corners_, s.span<uint32_t>(what.tears->columns.origin));
  }
  if (what.tears) {
    strands_.pack(*what.tears, what.body, schedule, s, {stiffness, damping[1], soft_, keeps_});
  }

  pack_volumes(what, s);
  pack_sheet(what, s);
  matcher_.prepare(what.matches, keeps_);
  if (is_simultaneous(options.sweep)) {
    std::vector<double> each;
    for (const Link& l : what.body.links)
      each.push_back(compliance(stiffness_of(stiffness, l.family) * l.factor));
    jacobi_.prepare(what.body, each);
  }
  if (what.colliders.empty() && !what.folds) return;
  for (auto* column : {&x_old_, &v_old_, &x_, &v_}) column->resize(3 * what.body.capacity);
  w_.resize(what.body.capacity);
  put_back_.resize((what.body.capacity + kBlockRows - 1) / kBlockRows);
}

template <class T>
void Solver<T>::load_chains(const SolverInput& what, const double* x, const StepInput& in) {
  const ChainSchedule& chains = what.schedule.chains;
  constexpr auto kLanes = static_cast<size_t>(Wide<T>::kLanes);
  in.arena.for_blocks(chains.batches.size(), 16, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      const ChainBatch& batch = chains.batches[b];
      for (size_t e = 0; e < batch.links * kLanes; ++e) {
        const uint32_t* p = chains.points.data() + batch.first_point + e;
        T* to = base_.data() + 3 * batch.first_link + 3 * (e - e % kLanes) + e % kLanes;
        const bool there = chains.link[batch.first_link + e] != kNobody;
        const Vec3 d = there ? load3(x, p[kLanes]) - load3(x, p[0]) : Vec3{};
        to[0] = static_cast<T>(d.x), to[kLanes] = static_cast<T>(d.y), to[2 * kLanes] = static_cast<T>(d.z);
      }
    }
  });
}

template <class T>
template <class Bends>
void Solver<T>::load_bends(const SetSchedule& schedule, const Bends& bends, const double* x, Set& out) const {
  constexpr auto kLanes = static_cast<size_t>(Wide<T>::kLanes);
  for (size_t e = 0; e < schedule.member.size(); ++e) {
    if (schedule.member[e] == kNobody) continue;
    const auto& bend = bends[schedule.member[e]];
    Vec3 sum;
    for (size_t i = 0; i < bend.points.size(); ++i) sum += load3(x, bend.points[i]) * bend.k[i];
    T* to = out.base.data() + 3 * (e - e % kLanes) + e % kLanes;
    to[0] = static_cast<T>(sum.x), to[kLanes] = static_cast<T>(sum.y), to[2 * kLanes] = static_cast<T>(sum.z);
  }
}

template <class T>
void Solver<T>::load_volumes(const SolverInput& what, const double* x) {
  constexpr auto kLanes = static_cast<size_t>(Wide<T>::kLanes);
  const SetSchedule& schedule = what.schedule.volumes;
  for (size_t e = 0; e < schedule.member.size(); ++e) {
    if (schedule.member[e] == kNobody) continue;
    const auto& p = what.body.tetrahedra[schedule.member[e]].points;
    T* to = volumes_.base.data() + 9 * (e - e % kLanes) + e % kLanes;
    for (size_t i = 1; i < 4; ++i, to += 3 * kLanes) {
      const Vec3 d = load3(x, p[i]) - load3(x, p[0]);
      to[0] = static_cast<T>(d.x), to[kLanes] = static_cast<T>(d.y), to[2 * kLanes] = static_cast<T>(d.z);
    }
  }
}

template <class T>
void Solver<T>::load(const SolverInput& what, const State& s, const StepInput& in) {
  const auto v = s.f64(Columns::velocity), w = s.f64(Columns::inverse_mass);
  const double* x = s.f64(Columns::position).data();
  points_ = w.size();
  in.arena.for_blocks(w.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (size_t k = 0; k < 3; ++k)
        rows_[4 * i + k] = 0, velocity_[4 * i + k] = static_cast<T>(v[3 * i + k]);
      rows_[4 * i + 3] = static_cast<T>(w[i]), velocity_[4 * i + 3] = 0;
    }
  });
  if (!what.rods.empty()) cosserat_.load(what.rods, s);
  load_chains(what, x, in);
  jacobi_.load(x, in.arena);
  if (what.tears) strands_.load(x);
  load_bends(what.schedule.rods, what.body.rods, x, rods_);
  load_bends(what.schedule.hinges, what.body.hinges, x, hinges_);
  load_volumes(what, x);
  load_sheet(what, x);
}

template void Solver<float>::pack_volumes(const SolverInput&, const State&);
template bool Solver<float>::same_corners(const SolverInput&, const State&);
template void Solver<float>::resize(size_t, size_t, size_t, Set&);
template void Solver<float>::pack_links(const SolverInput&, const State&);
template void Solver<float>::prepare(const SolverInput&, const State&);
template void Solver<float>::load_chains(const SolverInput&, const double*, const StepInput&);
template void Solver<float>::load_volumes(const SolverInput&, const double*);
template void Solver<float>::load(const SolverInput&, const State&, const StepInput&);
template void Solver<double>::pack_volumes(const SolverInput&, const State&);
template bool Solver<double>::same_corners(const SolverInput&, const State&);
template void Solver<double>::resize(size_t, size_t, size_t, Set&);
template void Solver<double>::pack_links(const SolverInput&, const State&);
template void Solver<double>::prepare(const SolverInput&, const State&);
template void Solver<double>::load_chains(const SolverInput&, const double*, const StepInput&);
template void Solver<double>::load_volumes(const SolverInput&, const double*);
template void Solver<double>::load(const SolverInput&, const State&, const StepInput&);

}  // namespace truestep::xpbd
