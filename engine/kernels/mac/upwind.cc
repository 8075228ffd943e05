#include "engine/kernels/mac/upwind.h"

namespace truestep::mac {

double upwind_rate(const MacGrid& g, size_t c, const ConstFields& u, double viscosity, size_t at) {
  const double* q = u[c] + at;
  const size_t sc = g.stride(c);
  double sum = 0;
  for (size_t a = 0; a < g.dimensions; ++a) {
    const size_t s = g.stride(a);
    const double* w = u[a] + at;
    // Of another component: the mean of the four faces around it.
    const double speed = a == c ? *q : 0.25 * ((w[0] + w[s]) + ((w - sc)[0] + (w - sc)[s]));
    const double behind = *q - *(q - s), ahead = q[s] - *q;
    sum -= speed * (speed > 0 ? behind : ahead) / g.spacing[a];
    sum += viscosity * (ahead - behind) / (g.spacing[a] * g.spacing[a]);
  }
  return sum;
}

}  // namespace truestep::mac
