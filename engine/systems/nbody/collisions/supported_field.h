// Attraction of bodies of which some rest against each other: along the line between the two of a pair the
// relative acceleration is taken away by equal and opposite pushes, those of all pairs together (a linear
// system, so that the forces are as smooth as the bare ones). For methods of the table, within a step.
#pragma once
#include <algorithm>

#include "engine/core/equations/force_field.h"
#include "engine/math/solvers/small_cholesky.h"
#include "engine/systems/nbody/collisions/collisions.h"
#include "engine/systems/nbody/collisions/resting_pairs.h"

namespace truestep::nbody {

class SupportedField final : public ForceField {
 public:
  /// Both must outlive this.
  SupportedField(const ForceField& bare, const std::vector<MetPair>& pairs) : bare_(bare), pairs_(pairs) {}

  State initial_state() const override { return bare_.initial_state(); }
  Dependence dependence() const override { return bare_.dependence(); }
  double kinetic(const Phase& at, Evaluation& e) const override { return bare_.kinetic(at, e); }
  void acceleration(const Phase& at, std::span<double> a, Evaluation& e) const override {
    bare_.acceleration(at, a, e);
    const auto mass = at.state.f64(Columns::mass);
    struct Held {
      uint32_t a, b;
      Vec3 n;
    };
    auto& held = e.workspace.object<std::vector<Held>>("nbody.held");
    held.clear();
    for (const MetPair& p : pairs_) {
      if (!p.resting) continue;
      held.push_back({p.a, p.b, normalized(load3(at.x.data(), p.b) - load3(at.x.data(), p.a))});
    }
    // Symmetric: of pair k, what a push of 1 between the pair l does to its relative acceleration.
    const size_t m = held.size();
    const auto matrix = e.workspace.doubles("nbody.held_matrix", m * m);
    const auto push = e.workspace.doubles("nbody.held_push", m);
    constexpr double kLight = 1e-9;  // of the heaviest: bodies without mass are that
    double heaviest = 0;
    for (const double each : mass) heaviest = std::max(heaviest, each);
    const auto inverse = [&](uint32_t i) {
      return heaviest > 0 ? 1 / std::max(mass[i] / heaviest, kLight) : 1;
    };
    for (size_t k = 0; k < m; ++k) {
      const Held& p = held[k];
      push[k] = -dot(load3(a.data(), p.b) - load3(a.data(), p.a), p.n);
      for (size_t l = 0; l <= k; ++l) {
        const Held& q = held[l];
        const auto share = [&](uint32_t i) {
          return inverse(i) * ((i == q.b ? 1 : 0) - (i == q.a ? 1 : 0)) * dot(p.n, q.n);
        };
        matrix[k * m + l] = share(p.b) - share(p.a);
      }
      matrix[k * m + k] *= 1 + 1e-12;  // more pairs than can move
    }
    cholesky_solve(matrix.data(), push.data(), m);
    for (size_t k = 0; k < m; ++k) {
      const Held& p = held[k];
      store3(a.data(), p.a, load3(a.data(), p.a) - p.n * (push[k] * inverse(p.a)));
      store3(a.data(), p.b, load3(a.data(), p.b) + p.n * (push[k] * inverse(p.b)));
    }
  }

 private:
  const ForceField& bare_;
  const std::vector<MetPair>& pairs_;
};

}  // namespace truestep::nbody
