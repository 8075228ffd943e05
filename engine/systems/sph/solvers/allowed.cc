#include "engine/systems/sph/solvers/allowed.h"

namespace truestep::sph {

template <int D, class T>
double Allowed<D, T>::by_fall(double gravity) const {
  return gravity > 0 ? kFall * std::sqrt(set_.def.spacing / gravity) : HUGE_VAL;
}

template <int D, class T>
double Allowed<D, T>::fastest(const State& s, Fluid<D, T>& f, double solids, const ThreadArena& arena) const {
  const auto v = s.span<T>(columns::velocity);
  f.partial.assign((f.n + kBlockRows - 1) / kBlockRows, 0);
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    double most = 0;
    for (size_t k = begin; k < end; ++k) {
      double square = 0;
      for (size_t a = 0; a < D; ++a) square += double{v[3 * k + a]} * double{v[3 * k + a]};
      if (!(square <= most)) most = square;
    }
    f.partial[begin / kBlockRows] = most;
  });
  double most = solids * solids;
  for (const Inlet& inlet : set_.inlets) most = std::max(most, inlet.speed * inlet.speed);
  for (const double square : f.partial) {
    if (!(square <= most)) most = square;
  }
  return std::sqrt(most);
}

template <int D, class T>
double Allowed<D, T>::by_speed(double speed, const Vec3& gravity) const {
  const SphDef& d = set_.def;
  const double sound = d.solver == Method::wcsph ? set_.sound / std::sqrt(set_.lightest) : 0;
  const double half = 0.5 * (speed + sound), reach = d.courant * d.spacing;
  // Speed that includes acceleration by gravity on the way.
  const double way = half + std::sqrt(half * half + norm(gravity) * reach);
  return way > 0 ? reach / way : way == 0 ? HUGE_VAL : way;
}

template <int D, class T>
double Allowed<D, T>::by_weight(const State& s, Fluid<D, T>& f, const Vec3& gravity,
                                const ThreadArena& arena) const {
  const SphDef& d = set_.def;
  const double g = norm(gravity);
  if (!(g > 0) || d.solver == Method::wcsph) return HUGE_VAL;
  double out = by_fall(g);
  const T* place = s.span<T>(columns::position).data();
  const auto load = [&] {
    return load_by_weight<D>(set_, place, s.span<T>(set_.ratio).data(), f.n, gravity, f.partial);
  };
  if (d.solver == Method::pbf) {
    const double under = std::max(depth<D>(place, f.n, gravity / g, f.partial, arena), d.spacing);
    const double most = d.pbf_iterations == 1 ? kCarriedByOne : kCarried;
    out = std::min(out, d.spacing * std::sqrt(most * d.pbf_iterations / (g * under)));
    // Not by the pressures found: those of a shorter substep are larger, and would shorten the next.
    if (set_.ratio) {
      const double layers = std::min(most, kCarriedLayers) * d.pbf_iterations, by = load();
      if (by > 0) out = std::min(out, d.spacing * std::sqrt(layers / by));
    }
  } else if (set_.ratio) {
    const double found = load_of_pressures(s.span<T>(columns::push).data(), s.span<T>(columns::flow).data(),
                                           s.span<T>(set_.ratio).data(), f.n, f.partial, arena);
    out = std::min(out, kHeld * d.spacing / std::sqrt(std::min(found, kMostOverWeight * load())));
  }
  return out;
}

template class Allowed<2, float>;
template class Allowed<3, float>;
template class Allowed<2, double>;
template class Allowed<3, double>;

}  // namespace truestep::sph
