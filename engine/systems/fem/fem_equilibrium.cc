// Prescribed displacements, and the equilibrium of quasi-static motion under them.
#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/integrators/implicit/newton/stage_newton.h"
#include "engine/systems/fem/fem.h"

namespace truestep::fem {

using Columns = FemColumns;

// Target of a node's prescribed components at time t; visit(index of the component, position).
template <class Visit>
void Fem::prescribed(double t, Visit visit) const {
  for (const Hold& hold : body().holds) {
    for (const uint32_t p : hold.nodes) {
      const Vec3& at = body().mesh.x[p];
      const double rest[3] = {at.x, at.y, at.z};
      const ExpressionRows::Column in[] = {{&t, 0}, {&rest[0], 0}, {&rest[1], 0}, {&rest[2], 0}};
      double moved[3];
      ExpressionRows::Output out[3];
      size_t count = 0;
      for (size_t c = 0; c < 3; ++c) {
        if (hold.axes >> c & 1) out[count++] = {&moved[c], 1};
      }
      hold.displacement.run(in, {out, count}, 0, 1);
      for (size_t c = 0; c < 3; ++c) {
        if (hold.axes >> c & 1) visit(3 * p + c, rest[c] + moved[c]);
      }
    }
  }
}

// A node held in all components gets the velocity that takes it to its target: every method moves points
// without acceleration by h v. Single components jump there at once and have no velocity during the step:
// methods that minimise a potential do not handle a component that moves without a force.
void Fem::begin_holds(State& s, double t, double h) const {
  const auto x = s.f64(Columns::position), v = s.f64(Columns::velocity), w = s.f64(Columns::inverse_mass);
  prescribed(t + h, [&](size_t k, double place) {
    if (!(w[k / 3] > 0)) {
      v[k] = (place - x[k]) / h;
    } else {
      x[k] = place, v[k] = 0;
    }
  });
}
void Fem::end_holds(State& s, double t, double h) const {
  const auto v = s.f64(Columns::velocity), w = s.f64(Columns::inverse_mass);
  prescribed(t + h, [&](size_t k, double place) {
    if (w[k / 3] > 0) v[k] = place / h;
  });
  prescribed(t, [&](size_t k, double place) {
    if (w[k / 3] > 0) v[k] -= place / h;
  });
}

// Solves the equation of a stage, M (u - u0) = s f(x0 + s u), with s so large that the M term is below
// rounding: the solution has f = 0. If none is found, the step is made in parts: the imbalance at its start
// is then removed gradually, and prescribed displacements are applied gradually. A step has nothing to do if
// its forces are as well balanced at its start as the last one left them and prescribed displacements are in
// place.
void Fem::equilibrium(State& s, const StepInput& in) const {
  constexpr double kBeyondMass = 1e12;  // times the fastest period
  constexpr double kShortest = 1.0 / 256;
  const auto x = s.f64(Columns::position), v = s.f64(Columns::velocity), w = s.f64(Columns::inverse_mass),
             balance = s.f64(Columns::balance);
  const size_t n = x.size();
  const auto scratch = [&](std::string_view key) { return in.workspace.doubles(key, n); };
  const auto start = scratch("fem.start"), kept = scratch("fem.v_kept"), reached = scratch("fem.reached"),
             u = scratch("fem.u"), none = scratch("fem.none"), first = scratch("fem.first");
  const auto copy = [](std::span<const double> from, std::span<double> to) {
    std::copy(from.begin(), from.end(), to.begin());
  };
  copy(x, start), copy(x, reached), copy(v, kept);
  std::fill(none.begin(), none.end(), 0.0);
  std::fill(balance.begin(), balance.end(), 0.0);
  truestep::Motion m(force_field(), s, in);
  const auto out_of_balance = [&] {
    m.acceleration(in.t + in.h, x, none, first);
    double most = 0;
    for (size_t k = 0; k < n; ++k) {
      first[k] *= body().masses[k / 3];
      most = std::max(most, std::abs(first[k]));
    }
    return most;
  };
  double& unbalanced = s.f64(Columns::unbalanced)[0];
  bool in_place = true;
  prescribed(in.t + in.h, [&](size_t k, double place) { in_place = in_place && x[k] == place; });
  if (out_of_balance() <= unbalanced && in_place) {
    std::fill(v.begin(), v.end(), 0.0);
    return;
  }
  const auto held = [&](size_t k) { return body().axes[k / 3] >> (k % 3) & 1 || !(w[k / 3] > 0); };
  bool all_held = true;
  for (size_t k = 0; k < n; ++k) all_held = all_held && held(k);
  if (all_held) {  // nothing to solve for
    prescribed(in.t + in.h, [&](size_t k, double place) { x[k] = place; });
    unbalanced = out_of_balance();
    for (size_t k = 0; k < n; ++k) v[k] = (x[k] - start[k]) / in.h;
    return;
  }

  const double scale = kBeyondMass / force_field().stiffness(s)->omega;
  double done = 0, share = 1;
  while (done < 1) {
    share = std::min(share, 1 - done);
    const double left = 1 - (done + share);
    // Prescribed components jump there at once; the last step's displacements are the guess for the others.
    prescribed(in.t + (done + share) * in.h, [&](size_t k, double place) { x[k] = place; });
    for (size_t k = 0; k < n; ++k) {
      u[k] = held(k) ? 0 : share * in.h / scale * kept[k];
      balance[k] = left * first[k];
    }
    const auto take_back = [&] {
      copy(reached, x), copy(kept, v);
      std::fill(balance.begin(), balance.end(), 0.0);
    };
    try {
      StageNewton(m, options())
          .solve({.t = in.t + in.h,
                  .g = scale,
                  .s = scale,
                  .x0 = x,
                  .u0 = none,
                  .end = StageEquation::End::correction},
                 u);
    } catch (const Instability& failure) {
      share *= 0.5;
      take_back();
      if (share >= kShortest) continue;
      copy(start, x);
      throw Instability(
          "", "position", -1,
          std::string("no equilibrium was found, not even for 1/256 of the step's load: ") + failure.what());
    }
    for (size_t k = 0; k < n; ++k) x[k] += scale * u[k];
    copy(x, reached);
    done += share;
  }
  std::fill(balance.begin(), balance.end(), 0.0);
  unbalanced = out_of_balance();
  for (size_t k = 0; k < n; ++k) v[k] = (x[k] - start[k]) / in.h;
}

}  // namespace truestep::fem
