// The `advance` column of the explicit Runge-Kutta rows. Step laws: the pairs' own codes where these exist
// (DOPRI5 and DOP853: Hairer, Norsett, Wanner 1993, appendix; proportional-integral control with beta 0.04
// for order 5, none for order 8, whose error estimate is smooth enough).
#include "engine/integrators/explicit/drive_fixed.h"
#include "engine/integrators/explicit/explicit_pair.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

namespace {

/// in.fixed_steps equal steps; of up to four equations with the tableau known to the compiler.
template <const Tableau& T>
void advance_fixed(Advance& in) {
  if (in.f.size() > 4) {
    ExplicitPair<T, 0, Sums::plain> method(in);
    return drive_fixed(in, method);
  }
  ExplicitPair<T, 4, Sums::plain> method(in);
  drive_fixed(in, method);
}

}  // namespace

void advance_euler(Advance& in) {
  // A second path: 1e6 lattice nodes at two to three times the speed (tests/bench/heat.cc).
  const auto at = [&](uint64_t i) {
    return in.t + static_cast<double>(i) * ((in.t_end - in.t) / static_cast<double>(in.fixed_steps));
  };
  const double h = (in.t_end - in.t) / static_cast<double>(in.fixed_steps);
  if (in.watcher || !in.f.euler_in_place(in.t, h, in.y)) return advance_fixed<kEulerTableau>(in);
  for (uint64_t i = 1; i < in.fixed_steps; ++i) in.f.euler_in_place(at(i), h, in.y);
  if (in.statistics) in.statistics->steps += in.fixed_steps, in.statistics->rates += in.fixed_steps;
  in.reached = in.t_end;
}
void advance_midpoint(Advance& in) {
  advance_fixed<kMidpointTableau>(in);
}
void advance_heun(Advance& in) {
  advance_fixed<kHeunTableau>(in);
}
void advance_rk4(Advance& in) {
  advance_fixed<kRk4Tableau>(in);
}
void advance_step_doubling(Advance& in) {
  ExplicitPair<kStepDoublingTableau, 0, Sums::plain> pair(in);
  drive(in, pair, {.q = 5, .beta = 0});
}
void advance_bs32(Advance& in) {
  advance_pair<kBs32Tableau, Sums::plain, 4, 8, 12>(in, {.q = 3});
}
void advance_rkf45(Advance& in) {
  advance_pair<kRkf45Tableau, Sums::plain, 4, 8>(in, {.q = 5});
}

}  // namespace truestep
