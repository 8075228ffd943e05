// The columns of a state of bodies as what collides sees them: places, speeds, masses, reaches.
#pragma once
#include "engine/math/vec3.h"
#include "engine/systems/nbody/nbody_state.h"

namespace truestep::nbody {

struct Pair {
  uint32_t a, b;
  friend bool operator==(const Pair&, const Pair&) = default;
};

class Balls {
 public:
  explicit Balls(State& s) : s_(s) {}
  State& state() const { return s_; }
  size_t count() const { return s_.rows(Columns::position); }
  double* x() const { return s_.f64(Columns::position).data(); }  ///< m
  double* v() const { return s_.f64(Columns::velocity).data(); }  ///< m/s
  double mass(uint32_t i) const { return s_.f64(Columns::mass)[i]; }
  std::span<const double> radii() const { return s_.f64(Columns::radius); }
  /// Distance of the centres of two balls that touch (m).
  double reach(uint32_t a, uint32_t b) const { return radii()[a] + radii()[b]; }
  double gravitational_constant() const { return parameter(s_, Parameter::gravitational_constant); }

 private:
  State& s_;
};

}  // namespace truestep::nbody
