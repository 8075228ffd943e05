// Boris's pusher for charged particles, with the exact angle (Boris 1970; Birdsall & Langdon 1985, ch. 4-3
// and 4-4): half a rotation about B, a kick by everything that varies in space and time, half a rotation.
// With W u = u x B/|B| and theta = q |B| s / m, the turn over a time s in uniform fields a = g + q E / m and
// B is
//   v' = v + sin(theta) W v + (1 - cos(theta)) W^2 v + s (a + c1 W a + c2 W^2 a)
//   x' = x + s (v + c1 W v + c2 W^2 v) + s^2 (a/2 + d1 W a + d2 W^2 a)
//   c1 = (1 - cos)/theta, c2 = 1 - sin/theta, d1 = c2/theta, d2 = 1/2 - c1/theta
// with sin = 2 T/(1 + T^2), 1 - cos = T sin, T = tan(theta/2): gyration, E x B drift and free fall are exact
// for any step; other forces cost one evaluation at the middle and an error of order h^2 that does not grow.
// Not covered: magnetic fields that vary in space, relativity, velocity-dependent forces.
#pragma once
#include "engine/core/equations/integrator.h"
#include "engine/math/vec3.h"
#include "engine/systems/particles/particles_def.h"

namespace truestep::particles {

inline constexpr std::string_view kBorisName = "boris";

/// A row like those of the table, for fields of this system alone.
const Integrator& boris();

/// One sentence why the method cannot handle these particles, or empty.
std::optional<std::string> boris_refusal(const ParticlesDef& def);

/// The motion of one particle in uniform fields over a time s (s) with B's unit vector, rate q |B| / m (1/s).
class UniformTurn {
 public:
  UniformTurn(const Vec3& unit, double rate, double s);
  /// Moves x (m) and v (m/s) under the acceleration a (m/s^2).
  void apply(Vec3& x, Vec3& v, const Vec3& a) const;

 private:
  Vec3 unit_;
  double s_, sin_, versine_, c1_, c2_, d1_, d2_;
};

}  // namespace truestep::particles
