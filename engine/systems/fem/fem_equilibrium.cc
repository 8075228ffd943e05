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

namespace {

// The largest change of an edge from an element's first node to another, over its length before: strain and
// rotation. Edges shorter than a hundredth of their length at rest count as that.
double change(const Mesh& mesh, std::span<const double> before, std::span<const double> after) {
  constexpr double kCollapsed = 1e-4;
  double most = 0;
  for (size_t k = 0; k < mesh.cells(); ++k) {
    const auto nodes = mesh.cell(k);
    const uint32_t o = nodes[0];
    const auto edge = [&](std::span<const double> x, uint32_t p) {
      return load3(x.data(), p) - load3(x.data(), o);
    };
    for (const uint32_t p : nodes.subspan(1)) {
      const Vec3 now = edge(before, p);
      const double length2 = std::max(norm2(now), kCollapsed * norm2(mesh.x[p] - mesh.x[o]));
      most = std::max(most, norm2(edge(after, p) - now) / length2);
    }
  }
  return std::sqrt(most);
}

}  // namespace

// An equilibrium on the way to that of a step; the imbalance at the step's start is removed as the way goes
// on.
struct Fem::Way {
  truestep::Motion motion;
  // N, start of the step, end of the last part; m/s, velocity in the last part, solution; and what is
  // computed.
  std::span<double> imbalance, start, reached, kept, u, guess, none;

  Way(const ForceField& field, State& s, const StepInput& in) : motion(field, s, in) {
    const auto scratch = [&](std::string_view key) {
      return in.workspace.doubles(key, s.f64(Columns::position).size());
    };
    imbalance = scratch("fem.first"), start = scratch("fem.start"), reached = scratch("fem.reached");
    kept = scratch("fem.v_kept"), u = scratch("fem.u"), guess = scratch("fem.guess");
    none = scratch("fem.none");
    std::fill(none.begin(), none.end(), 0.0);
  }
};

// N, the largest force on what is free at the end of the step; all of them in `imbalance`.
double Fem::find_imbalance(const State& s, const StepInput& in, Way& way) const {
  way.motion.acceleration(in.t + in.h, s.f64(Columns::position), way.none, way.imbalance);
  double most = 0;
  for (size_t k = 0; k < way.imbalance.size(); ++k) {
    way.imbalance[k] *= body().masses[k / 3];
    most = std::max(most, std::abs(way.imbalance[k]));
  }
  return most;
}

bool Fem::holds(const State& s, size_t k) const {
  return body().axes[k / 3] >> (k % 3) & 1 || !(s.f64(Columns::inverse_mass)[k / 3] > 0);
}

// A step has nothing to do if its forces are as well balanced at its start as the last one left them and
// prescribed displacements are in place.
void Fem::equilibrium(State& s, const StepInput& in) const {
  const auto x = s.f64(Columns::position), v = s.f64(Columns::velocity), balance = s.f64(Columns::balance);
  Way way(force_field(), s, in);
  std::copy(x.begin(), x.end(), way.start.begin());
  std::copy(v.begin(), v.end(), way.kept.begin());
  std::fill(balance.begin(), balance.end(), 0.0);
  double& unbalanced = s.f64(Columns::unbalanced)[0];
  bool in_place = true, all_held = true;
  prescribed(in.t + in.h, [&](size_t k, double place) { in_place = in_place && x[k] == place; });
  if (find_imbalance(s, in, way) <= unbalanced && in_place) {
    std::fill(v.begin(), v.end(), 0.0);
    return;
  }
  for (size_t k = 0; k < x.size(); ++k) all_held = all_held && holds(s, k);
  if (all_held) {  // nothing to solve for
    prescribed(in.t + in.h, [&](size_t k, double place) { x[k] = place; });
  } else {
    solve_in_parts(s, in, way);
  }
  unbalanced = find_imbalance(s, in, way);
  for (size_t k = 0; k < x.size(); ++k) v[k] = (x[k] - way.start[k]) / in.h;
}

// Solves the equation of a stage, M (u - u0) = s f(x0 + s u), with s so large that the M term is below
// rounding: the solution has f = 0. Elements that a guess turns inside out lead to other equilibria than
// those that a body reaches on its way, so a step is made in parts in which neither the guess nor the
// solution changes elements by more than kMostChange: the imbalance at its start is then removed gradually,
// and prescribed displacements are applied gradually. So it is if no equilibrium is found. What snaps changes
// by much under any load: parts of kUnwatched and less are taken as they are found, and where the way ends
// the rest of the step is tried at once.
void Fem::solve_in_parts(State& s, const StepInput& in, Way& way) const {
  constexpr double kBeyondMass = 1e12;  // times the fastest period
  constexpr double kShortest = 1.0 / 1024;
  constexpr double kUnwatched = 1.0 / 32;
  constexpr double kMostChange =
      0.25;  // three blocks pressed by half and more came to the same from 0.05 to 0.4
  const auto x = s.f64(Columns::position), v = s.f64(Columns::velocity), balance = s.f64(Columns::balance);
  const size_t n = x.size();
  const auto copy = [](std::span<const double> from, std::span<double> to) {
    std::copy(from.begin(), from.end(), to.begin());
  };
  copy(x, way.reached);
  const double scale = kBeyondMass / force_field().stiffness(s)->omega;
  const auto shorten = [&](double& share) {
    share *= 0.5;
    copy(way.reached, x);
    std::fill(balance.begin(), balance.end(), 0.0);
  };
  double done = 0, share = 1;
  bool gradual = true;
  while (done < 1) {
    share = std::min(share, 1 - done);
    const double left = 1 - (done + share);
    // Prescribed components jump there at once; the last displacements are the guess for the others.
    prescribed(in.t + (done + share) * in.h, [&](size_t k, double place) { x[k] = place; });
    for (size_t k = 0; k < n; ++k) {
      way.u[k] = holds(s, k) ? 0 : share * in.h / scale * way.kept[k];
      way.guess[k] = x[k] + scale * way.u[k];
      balance[k] = left * way.imbalance[k];
    }
    if (gradual && share > kShortest && change(body().mesh, way.reached, way.guess) > kMostChange) {
      shorten(share);
      continue;
    }
    try {
      StageNewton(way.motion, options())
          .solve({.t = in.t + in.h,
                  .g = scale,
                  .s = scale,
                  .x0 = x,
                  .u0 = way.none,
                  .end = StageEquation::End::correction},
                 way.u);
    } catch (const Instability& failure) {
      shorten(share);
      copy(way.kept, v);
      if (share < kShortest && gradual) gradual = false, share = 1;
      if (share >= kShortest) continue;
      copy(way.start, x);
      throw Instability(
          "", "position", -1,
          std::string("no equilibrium was found, not even for 1/1024 of the step's load: ") + failure.what());
    }
    for (size_t k = 0; k < n; ++k) x[k] += scale * way.u[k];
    const double changed = change(body().mesh, way.reached, x);
    if (gradual && share > kUnwatched && changed > kMostChange) {
      shorten(share);
      continue;
    }
    for (size_t k = 0; k < n; ++k) way.kept[k] = (x[k] - way.reached[k]) / (share * in.h);
    copy(x, way.reached);
    done += share;
    if (changed < 0.5 * kMostChange) share *= 2;
  }
  std::fill(balance.begin(), balance.end(), 0.0);
}

}  // namespace truestep::fem
