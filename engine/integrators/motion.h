// A step in progress: flat views of position and velocity, evaluations of the right-hand side, and scratch
// arrays that the workspace keeps from step to step. Every method builds on this.
#pragma once
#include <span>
#include <string_view>

#include "engine/base/interrupt.h"
#include "engine/core/equations/integrator.h"

namespace truestep {

/// Elements per block of a flat loop: 16 KiB per array, so that a few arrays stay in the first-level cache.
inline constexpr size_t kBlockElements = 2048;

class Motion {
 public:
  Motion(const ForceField& field, State& state, const StepInput& input)
      : field(field),
        state(state),
        input(input),
        x(state.f64(state.at("position"))),
        v(state.f64(state.at("velocity"))),
        e_{input.workspace, input.arena} {}

  const ForceField& field;
  State& state;
  const StepInput& input;
  std::span<double> x, v;  ///< the state's own columns

  /// n numbers of scratch under a name used only by the integrators.
  std::span<double> scratch(std::string_view key, size_t n) { return input.workspace.doubles(key, n); }

  /// a(x, v, t) into `a`.
  void acceleration(double t, std::span<const double> x_at, std::span<const double> v_at,
                    std::span<double> a) {
    interruption_point();
    field.acceleration({t, x_at, v_at, state}, a, e_);
  }
  /// G(x) v: in `rate`, or v_at itself if G is the identity.
  std::span<const double> rate(double t, std::span<const double> x_at, std::span<const double> v_at,
                               std::span<double> rate) {
    return field.position_rate({t, x_at, v_at, state}, rate, e_);
  }
  /// Whether dx/dt is v itself.
  bool plain_rate() {
    return x.size() == v.size() &&
           rate(input.t, x, v, scratch("integrator.rate", x.size())).data() == v.data();
  }
  void project() { field.project(x, v, state); }

  /// body(i) for all i of [0, n), in fixed blocks over the threads; the inner loop vectorises.
  template <class Body>
  void loop(size_t n, Body body) const {
    input.arena.for_blocks(n, kBlockElements, [&body](size_t begin, size_t end) {
#pragma GCC ivdep
      for (size_t i = begin; i < end; ++i) body(i);
    });
  }

 private:
  Evaluation e_;
};

}  // namespace truestep
