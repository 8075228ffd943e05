// Forces on single particles, as accelerations over rows [begin, end) of flat n x 3 arrays:
//   gravity             a  = g
//   drag                a -= (c1 + c2 |u|) u / m,               u = v - wind
//   attractor           a += mu d / (|d|^2 + eps^2)^(3/2),      d = centre - x
//   charge              a += q (E + v x B) / m
//   propulsion          a += thrust e / m,                      e = v/|v| or fixed
// Each loop runs over contiguous rows and vectorises; terms that are zero are skipped.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/math/vec3.h"

namespace truestep::particles {

/// The active forces, read from a state once per evaluation.
struct BodyForces {
  Vec3 gravity, wind;
  double linear_drag = 0, quadratic_drag = 0;
  std::span<const double> attractors;  ///< rows of 5: position, mu, softening
  double charge = 0;
  std::span<const double> charges;  ///< one per row, overriding `charge`; empty: none
  Vec3 electric, magnetic;
  double thrust = 0;
  std::optional<Vec3> thrust_direction;  ///< unit vector; empty: along the velocity
};

/// Flat columns that the loops read.
struct ParticleArrays {
  const double* x;
  const double* v;
  const double* mass;
};

/// Writes the accelerations of rows [begin, end) to a.
void body_accelerations(const BodyForces& f, const ParticleArrays& p, double* a, size_t begin, size_t end);

/// Potential energy (J) of gravity, attractors and the electric field over rows [begin, end).
double body_potential(const BodyForces& f, const ParticleArrays& p, size_t begin, size_t end);

}  // namespace truestep::particles
