// The solver's part for membranes and tethers.
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "engine/kernels/xpbd/membrane.h"
#include "engine/systems/xpbd/solver.h"

namespace truestep::xpbd {

using Columns = XpbdColumns;

template <class T>
void Solver<T>::pack_sheet(const SolverInput& what, const State& s) {
  constexpr auto kLanes = static_cast<size_t>(Wide<T>::kLanes);
  const std::vector<uint32_t>& member = what.schedule.sheet.member;
  const double modulus = stiffness_of(s.f64(Columns::stiffness), Family::structural);
  sheet_.k.assign(4 * member.size(), T(0)), sheet_.compliance.assign(member.size(), T(1));
  sheet_.lambda.assign(keeps_ ? 3 * member.size() : 0, T(0)), sheet_.base.assign(6 * member.size(), T(0));
  for (size_t e = 0; e < member.size(); ++e) {
    if (member[e] == kNobody) continue;
    const SheetTriangle& t = what.body.sheet[member[e]];
    sheet_.compliance[e] = static_cast<T>(compliance(modulus * t.volume));
    for (size_t i = 0; i < 4; ++i) {
      sheet_.k[4 * (e - e % kLanes) + i * kLanes + e % kLanes] = static_cast<T>(t.inverse[i]);
    }
  }
  sheet_q_.resize(member.size() / kLanes);
}

template <class T>
void Solver<T>::load_sheet(const SolverInput& what, const double* x) {
  constexpr auto kLanes = static_cast<size_t>(Wide<T>::kLanes);
  const std::vector<uint32_t>& member = what.schedule.sheet.member;
  for (size_t e = 0; e < member.size(); ++e) {
    if (member[e] == kNobody) continue;
    const auto& p = what.body.sheet[member[e]].points;
    T* to = sheet_.base.data() + 6 * (e - e % kLanes) + e % kLanes;
    for (size_t i = 1; i < 3; ++i, to += 3 * kLanes) {
      const Vec3 d = load3(x, p[i]) - load3(x, p[0]);
      to[0] = static_cast<T>(d.x), to[kLanes] = static_cast<T>(d.y), to[2 * kLanes] = static_cast<T>(d.z);
    }
  }
}

template <class T>
double Solver<T>::solve_sheet(const SolverInput& what, const StepInput& in, double h) {
  const SetSchedule& schedule = what.schedule.sheet;
  if (schedule.member.empty()) return 0;
  constexpr auto kLanes = static_cast<size_t>(Wide<T>::kLanes);
  const PerStep<T> per = per_step<T>(h);
  each_batch(schedule, in, [&](size_t b) {
    const MembraneSet<T> set{
        schedule.points.data() + 3 * kLanes * b,  sheet_.k.data() + 4 * kLanes * b,
        sheet_.compliance.data() + kLanes * b,    static_cast<T>(what.options.sheet_ratio),
        lambda_of(sheet_.lambda, 3 * kLanes * b), sheet_.base.data() + 6 * kLanes * b};
    sheet_q_[b] = what.options.membrane == Membrane::neo_hookean
                      ? solve_neo_hookean_membrane<T>(set, per, rows_.data())
                      : solve_st_venant_kirchhoff<T>(set, per, relax_, rows_.data());
  });
  return *std::max_element(sheet_q_.begin(), sheet_q_.end());
}

template <class T>
void Solver<T>::hold_tethers(const SolverInput& what, const State& s, const StepInput& in) {
  const double* start = s.f64(Columns::position).data();
  in.arena.for_blocks(what.tethers.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (const Tether& t : what.tethers.subspan(begin, end - begin)) {
      T *row = rows_.data() + 4 * size_t{t.point}, *at = rows_.data() + 4 * size_t{t.anchor};
      // A command may have pinned one or released the other.
      if (!(row[3] > 0) || at[3] > 0) continue;
      const Vec3 anchor = load3(start, t.anchor) + Vec3{at[0], at[1], at[2]};
      const Vec3 d = load3(start, t.point) + Vec3{row[0], row[1], row[2]} - anchor;
      const double l = norm(d);
      if (!(l > t.length)) continue;
      const Vec3 by = d * (t.length / l - 1);
      row[0] += static_cast<T>(by.x), row[1] += static_cast<T>(by.y), row[2] += static_cast<T>(by.z);
    }
  });
}

#define TRUESTEP_SHEET(T)                                                               \
  template void Solver<T>::pack_sheet(const SolverInput&, const State&);                \
  template void Solver<T>::load_sheet(const SolverInput&, const double*);               \
  template double Solver<T>::solve_sheet(const SolverInput&, const StepInput&, double); \
  template void Solver<T>::hold_tethers(const SolverInput&, const State&, const StepInput&);
TRUESTEP_SHEET(float)
TRUESTEP_SHEET(double)
#undef TRUESTEP_SHEET

}  // namespace truestep::xpbd
