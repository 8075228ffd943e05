#include "engine/systems/sph/solvers/vorticity.h"

#include <cmath>

#include "engine/systems/sph/solvers/passes.h"

namespace truestep::sph {

template <int D, class T>
void confine_vorticity(Fluid<D, T>& f, T strength, T spacing, T h, const ThreadArena& arena) {
  using W = Wide<T>;
  f.omega.resize(4 * f.n);
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W curl[3] = {W::zero(), W::zero(), W::zero()};
    for (size_t k = begin; k < end; k += W::kLanes) {
      W u[4], g[3] = {W::zero(), W::zero(), W::zero()};
      c.rows_of(f.v, k, u);
      for (size_t a = 0; a < 3; ++a) u[a] = u[a] - W::all(f.v[4 * i + a]);
      for (size_t a = 0; a < D; ++a) g[a] = c.gradient(a, k);
      curl[0] += g[1] * u[2] - g[2] * u[1];
      curl[1] += g[2] * u[0] - g[0] * u[2];
      curl[2] += g[0] * u[1] - g[1] * u[0];
    }
    T* o = f.omega.data() + 4 * i;
    for (size_t a = 0; a < 3; ++a) o[a] = f.unit * sum(curl[a]);
    o[3] = std::sqrt(o[0] * o[0] + o[1] * o[1] + o[2] * o[2]);
  });
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W eta[D];
    for (auto& e : eta) e = W::zero();
    const T* o = f.omega.data() + 4 * i;
    for (size_t k = begin; k < end; k += W::kLanes) {
      W other[4];
      c.rows_of(f.omega, k, other);
      for (size_t a = 0; a < D; ++a) eta[a] = madd(c.gradient(a, k), other[3] - W::all(o[3]), eta[a]);
    }
    T n[3] = {};
    for (size_t a = 0; a < D; ++a) n[a] = sum(eta[a]);
    const T length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    const T scale = length > 0 ? strength * spacing / length : T{0};
    T* out = f.a.data() + 4 * i;
    out[0] = scale * (n[1] * o[2] - n[2] * o[1]);
    out[1] = scale * (n[2] * o[0] - n[0] * o[2]);
    out[2] = D == 3 ? scale * (n[0] * o[1] - n[1] * o[0]) : T{0};
    out[3] = 0;
  });
  kick(f, h, arena);
}

template void confine_vorticity(Fluid<2, float>&, float, float, float, const ThreadArena&);
template void confine_vorticity(Fluid<3, float>&, float, float, float, const ThreadArena&);
template void confine_vorticity(Fluid<2, double>&, double, double, double, const ThreadArena&);
template void confine_vorticity(Fluid<3, double>&, double, double, double, const ThreadArena&);

}  // namespace truestep::sph
