#include "engine/kernels/molecular/pair_law.h"

#include "engine/math/wide_rows.h"

namespace truestep::molecular {
namespace {

using W = Wide<double>;
enum class Kinds : uint8_t { one, many };
enum class Taper : uint8_t { none, switched };

double lane_sum(W a) {
  return (a[0] + a[1]) + (a[2] + a[3]);
}

/// Force over distance and energy, lane by lane.
struct Terms {
  W s, u;
};

template <Taper taper, Wanted wanted>
inline Terms lennard_jones(const PairLaw& law, W r2, W i2, W c12, W c6, W shift) {
  const W i6 = i2 * i2 * i2, a = c12 * i6;
  Terms t{i6 * i2 * madd(W(12.0), a, c6 * W(-6.0)), W::zero()};
  if constexpr (wanted == Wanted::energies || taper == Taper::switched) t.u = i6 * (a - c6);
  if constexpr (taper == Taper::switched) {
    const double gap = law.cutoff2 - law.from2, scale = 1 / (gap * gap * gap);
    const W left = W(law.cutoff2) - r2, beyond = r2 - W(law.from2);
    const auto inside = beyond < W::zero();
    const W s = left * left * (madd(W(2.0), r2, W(law.cutoff2 - 3 * law.from2))) * W(scale);
    const W slope = W(-6 * scale) * left * beyond;
    const W value = select(inside, W(1.0), s);
    t.s = t.s * value - W(2.0) * t.u * select(inside, W::zero(), slope);
    t.u = t.u * value;
  }
  t.u -= shift;
  return t;
}

template <PairLaw::Charges charges, Wanted wanted>
inline void add_coulomb(const PairLaw& law, W r2, W i2, W qq, Terms& t) {
  if constexpr (charges == PairLaw::Charges::none) return;
  const W i1 = sqrt(r2) * i2;
  if constexpr (charges == PairLaw::Charges::cutoff) {
    t.s += qq * (i1 * i2 - W(2 * law.a) - W(law.b) * i1);
    t.u += qq * (i1 + W(law.a) * r2 + W(law.b) * (r2 * i1) + W(law.c));
  } else {
    const double a2 = law.alpha * law.alpha;
    const W u = min(r2, W(law.cutoff2)) * W(a2);
    t.s += qq * (i1 * i2 - W(law.alpha * a2) * law.erf.g(u));
    if constexpr (wanted == Wanted::energies) t.u += qq * (i1 - W(law.alpha) * law.erf.e(u));
  }
}

template <Kinds kinds, Taper taper, PairLaw::Charges charges, Wanted wanted>
PairSum pair_sum(const PairLaw& law, const PairRows& p, uint32_t i, const uint32_t* list, size_t count) {
  const double* own = p.rows + 4 * static_cast<size_t>(i);
  const W x(own[0]), y(own[1]), z(own[2]), q(own[3] * law.coulomb);
  const W cutoff2(law.cutoff2), floor2(law.floor2), one(1.0);
  const double* table = law.table.data() + (kinds == Kinds::many ? 4 * law.kinds * p.kinds[i] : 0);
  W c12(table[0]), c6(table[1]), shift(table[2]);
  W fx = W::zero(), fy = fx, fz = fx, energy = fx, virial = fx;
  for (size_t k = 0; k < count; k += 4) {
    W row[4];
    gather_rows4(p.rows, list + k, row);
    const W dx = x - row[0], dy = y - row[1], dz = z - row[2];
    const W r2 = madd(dz, dz, madd(dy, dy, dx * dx));
    const auto near = r2 < cutoff2;
    const W safe2 = max(r2, floor2), i2 = one / safe2;
    if constexpr (kinds == Kinds::many) {
      uint32_t kind[4];
      for (int l = 0; l < 4; ++l) kind[l] = p.kinds[list[k + l]];
      W c[4];
      gather_rows4(table, kind, c);
      c12 = c[0], c6 = c[1], shift = c[2];
    }
    Terms t = lennard_jones<taper, wanted>(law, safe2, i2, c12, c6, shift);
    add_coulomb<charges, wanted>(law, safe2, i2, q * row[3], t);
    const W s = select(near, t.s, W::zero());
    fx = madd(s, dx, fx), fy = madd(s, dy, fy), fz = madd(s, dz, fz);
    if constexpr (wanted == Wanted::energies) {
      energy += select(near, t.u, W::zero());
      virial += s * r2;
    }
  }
  PairSum sum;
  sum.force = {lane_sum(fx), lane_sum(fy), lane_sum(fz)};
  if constexpr (wanted == Wanted::energies) {
    sum.energy = 0.5 * lane_sum(energy), sum.virial = 0.5 * lane_sum(virial);
  }
  return sum;
}

template <Kinds kinds, Taper taper, Wanted wanted>
PairSumFunction by_charges(const PairLaw& law) {
  switch (law.charges) {
    case PairLaw::Charges::none:
      return pair_sum<kinds, taper, PairLaw::Charges::none, wanted>;
    case PairLaw::Charges::cutoff:
      return pair_sum<kinds, taper, PairLaw::Charges::cutoff, wanted>;
    case PairLaw::Charges::ewald:
      break;
  }
  return pair_sum<kinds, taper, PairLaw::Charges::ewald, wanted>;
}
template <Kinds kinds, Wanted wanted>
PairSumFunction by_taper(const PairLaw& law) {
  return law.truncation == Truncation::switched ? by_charges<kinds, Taper::switched, wanted>(law)
                                                : by_charges<kinds, Taper::none, wanted>(law);
}
template <Wanted wanted>
PairSumFunction by_kinds(const PairLaw& law) {
  return law.kinds == 1 ? by_taper<Kinds::one, wanted>(law) : by_taper<Kinds::many, wanted>(law);
}

}  // namespace

PairSumFunction pair_sum_function(const PairLaw& law, Wanted wanted) {
  return wanted == Wanted::forces ? by_kinds<Wanted::forces>(law) : by_kinds<Wanted::energies>(law);
}

}  // namespace truestep::molecular
