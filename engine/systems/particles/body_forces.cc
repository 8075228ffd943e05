#include "engine/systems/particles/body_forces.h"

#include <cmath>

namespace truestep::particles {
namespace {

enum class Drag : uint8_t { linear, with_quadratic };

template <Drag drag>
void gravity_and_drag(const BodyForces& f, const double* __restrict v, const double* __restrict mass,
                      double* __restrict a, size_t begin, size_t end) {
  const Vec3 g = f.gravity, w = f.wind;
  const double c1 = f.linear_drag, c2 = f.quadratic_drag;
  for (size_t i = begin; i < end; ++i) {
    const double x = v[3 * i] - w.x, y = v[3 * i + 1] - w.y, z = v[3 * i + 2] - w.z;
    double c = c1;
    if constexpr (drag == Drag::with_quadratic) c += c2 * std::sqrt(x * x + y * y + z * z);
    c /= mass[i];
    a[3 * i] = g.x - c * x;
    a[3 * i + 1] = g.y - c * y;
    a[3 * i + 2] = g.z - c * z;
  }
}

void gravity_alone(const Vec3& g, double* __restrict a, size_t begin, size_t end) {
  for (size_t i = begin; i < end; ++i) a[3 * i] = g.x, a[3 * i + 1] = g.y, a[3 * i + 2] = g.z;
}

void attract(const double* row, const double* __restrict x, double* __restrict a, size_t begin, size_t end) {
  const double cx = row[0], cy = row[1], cz = row[2], mu = row[3], soft = row[4] * row[4];
  for (size_t i = begin; i < end; ++i) {
    const double dx = cx - x[3 * i], dy = cy - x[3 * i + 1], dz = cz - x[3 * i + 2];
    const double r2 = dx * dx + dy * dy + dz * dz + soft;
    // A particle exactly at the centre of an unsoftened attractor has no direction to go.
    const double s = r2 > 0 ? mu / (r2 * std::sqrt(r2)) : 0.0;
    a[3 * i] += s * dx, a[3 * i + 1] += s * dy, a[3 * i + 2] += s * dz;
  }
}

void lorentz(const BodyForces& f, const ParticleArrays& p, double* __restrict a, size_t begin, size_t end) {
  const Vec3 e = f.electric, b = f.magnetic;
  const double* __restrict v = p.v;
  for (size_t i = begin; i < end; ++i) {
    const double s = (f.charges.empty() ? f.charge : f.charges[i]) / p.mass[i], x = v[3 * i],
                 y = v[3 * i + 1], z = v[3 * i + 2];
    a[3 * i] += s * (e.x + y * b.z - z * b.y);
    a[3 * i + 1] += s * (e.y + z * b.x - x * b.z);
    a[3 * i + 2] += s * (e.z + x * b.y - y * b.x);
  }
}

void propel(const BodyForces& f, const ParticleArrays& p, double* __restrict a, size_t begin, size_t end) {
  for (size_t i = begin; i < end; ++i) {
    const Vec3 e = f.thrust_direction ? *f.thrust_direction : normalized(load3(p.v, i), Vec3{});
    const double s = f.thrust / p.mass[i];
    a[3 * i] += s * e.x, a[3 * i + 1] += s * e.y, a[3 * i + 2] += s * e.z;
  }
}

}  // namespace

void body_accelerations(const BodyForces& f, const ParticleArrays& p, double* a, size_t begin, size_t end) {
  if (f.quadratic_drag != 0) {
    gravity_and_drag<Drag::with_quadratic>(f, p.v, p.mass, a, begin, end);
  } else if (f.linear_drag != 0) {
    gravity_and_drag<Drag::linear>(f, p.v, p.mass, a, begin, end);
  } else {
    gravity_alone(f.gravity, a, begin, end);
  }
  for (size_t k = 0; k + 5 <= f.attractors.size(); k += 5) attract(&f.attractors[k], p.x, a, begin, end);
  if (f.charge != 0 || !f.charges.empty()) lorentz(f, p, a, begin, end);
  if (f.thrust != 0) propel(f, p, a, begin, end);
}

double body_potential(const BodyForces& f, const ParticleArrays& p, size_t begin, size_t end) {
  double sum = 0;
  for (size_t i = begin; i < end; ++i) {
    const Vec3 x = load3(p.x, i);
    double per_mass = -dot(f.gravity, x);
    for (size_t k = 0; k + 5 <= f.attractors.size(); k += 5) {
      const double* row = &f.attractors[k];
      const double r2 = norm2(load3(row, 0) - x) + row[4] * row[4];
      if (r2 > 0) per_mass -= row[3] / std::sqrt(r2);
    }
    sum += p.mass[i] * per_mass - (f.charges.empty() ? f.charge : f.charges[i]) * dot(f.electric, x);
  }
  return sum;
}

}  // namespace truestep::particles
