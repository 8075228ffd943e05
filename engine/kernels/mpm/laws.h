// Material laws of a particle with deformation gradient F, eight floats or four doubles at a time: Kirchhoff
// stress tau = P F^T (Pa), energy per undeformed volume (J/m^3), and the return mapping of the plastic laws.
// In the plane F is 2 x 2 and deviators are two-dimensional.
//   fluid        p = K/g (J^-g - 1), g = 7 (Cole 1948; Monaghan 1994); F is not used, only J
//   corotated    mu |F - R|^2 + lambda/2 (J - 1)^2 (Stomakhin, Howes, Schroeder, Teran 2012)
//   neo_hookean  mu/2 (|F|^2 - d) - mu ln J + lambda/2 (ln J)^2 (Bonet, Wood 2008)
//   snow         corotated with mu, lambda times e^(xi (1 - Jp)) and singular values of F in
//                [1 - theta_c, 1 + theta_s] (Stomakhin, Schroeder, Chai, Teran, Selle 2013)
//   sand         mu tr(e^2) + lambda/2 tr(e)^2 of the Hencky strain e, Drucker-Prager's cone and the volume
//                correction of Klar, Gast, Pradhana, Fu, Schroeder, Jiang, Teran 2016 (and Tampubolon 2017)
//   foam         the same energy with von Mises' limit |dev(2 mu e)| <= sqrt(2/3) yield_stress
//   elastic      any isotropic energy, given by its derivatives by the singular values
#pragma once
#include "engine/kernels/mpm/small_matrix.h"
#include "engine/math/trig.h"

namespace truestep::mpm {

enum class Law : unsigned char { fluid, corotated, neo_hookean, snow, sand, foam, elastic };

struct Material {
  Law law = Law::corotated;
  double mu = 0, lambda = 0;                     ///< Pa; for a fluid lambda is the bulk modulus
  double hardening = 10;                         ///< xi of snow
  double compression = 0.025, stretch = 0.0075;  ///< theta_c and theta_s of snow
  double cone = 0;                               ///< alpha of sand: sqrt(2/3) 2 sin(phi) / (3 - sin(phi))
  double yield = 0;                              ///< Pa, for foam
};

/// Smaller volume ratios are raised to this where a law has a pole at 0.
inline constexpr double kLeastVolume = 0.05;
/// Upper bound of e^(xi (1 - Jp)): snow compressed without limit would need infinitely many substeps.
inline constexpr double kMostHardening = 50;

/// ln of positive floats, by the series of atanh: 2 (s + s^3 / 3 + ...), s = (m - 1) / (m + 1), of the
/// mantissa m; the first omitted term is below 1e-9 of it.
inline Wide<float> log(Wide<float> a) {
  using W = Wide<float>;
  using Bits = W::Mask;
  const auto raw = (Bits)a.v;
  // The nearest power of two below 4/3 of a: m is in [2/3, 4/3).
  const Bits power = (raw - 0x3f2aaaab) >> 23;
  const W m((W::Raw)(raw - (power << 23))), e(__builtin_convertvector(power, W::Raw)), one(1);
  const W s = (m - one) / (m + one), s2 = s * s;
  W series(1.0 / 9);
  for (const double k : {1.0 / 7, 1.0 / 5, 1.0 / 3}) series = madd(series, s2, W(k));
  const W rest = madd(s * s2 * series, W(2), s + s);
  // ln 2 in two parts, the first short enough for exact products.
  return madd(e, W(0.693359375), madd(e, W(-2.12194440054690583e-4), rest));
}
/// e^a for a in [-87, 88]; a is clamped to these bounds.
inline Wide<float> exp(Wide<float> a) {
  using W = Wide<float>;
  using Bits = W::Mask;
  const W x = min(max(a, W(-87)), W(88));
  // Rounds to the nearest integer: from 2^23 on all floats are integers.
  const W big(12582912), n = madd(x, W(1.44269504088896341), big) - big;
  const W r = nmadd(n, W(-2.12194440054690583e-4), nmadd(n, W(0.693359375), x));
  W series(1.0 / 5040);
  for (const double k : {1.0 / 720, 1.0 / 120, 1.0 / 24, 1.0 / 6, 0.5, 1.0, 1.0})
    series = madd(series, r, W(k));
  const Bits power = __builtin_convertvector(n.v, Bits);
  return W((W::Raw)((Bits)series.v + (power << 23)));
}

template <class T>
Wide<T> log(Wide<T> a) {
  for (int i = 0; i < Wide<T>::kLanes; ++i) a.set(i, static_cast<T>(trig::log(double{a[i]})));
  return a;
}
template <class T>
Wide<T> exp(Wide<T> a) {
  for (int i = 0; i < Wide<T>::kLanes; ++i) a.set(i, static_cast<T>(trig::exp(double{a[i]})));
  return a;
}

/// Factor of snow on both moduli.
template <class T>
Wide<T> hardening(const Material& mat, Wide<T> jp) {
  const T most = static_cast<T>(kMostHardening);
  Wide<T> e = Wide<T>(mat.hardening) * (Wide<T>(1) - jp);
  return min(exp(min(e, Wide<T>(5))), Wide<T>(most));
}

template <int D, class T>
struct Response {
  Square<D, T> tau;  ///< Pa
  Wide<T> energy;    ///< J/m^3
  Wide<T> modulus;   ///< Pa, density times the square of the fastest wave's speed
};

namespace detail {

template <int D, class T>
Square<D, T> isotropic(Wide<T> p) {
  Square<D, T> out = Square<D, T>::identity();
  for (int k = 0; k < D; ++k) out(k, k) = p;
  return out;
}

/// Stress from principal values along the columns of u.
template <int D, class T>
Response<D, T> principal(const Square<D, T>& u, const Wide<T>* tau, Wide<T> energy, Wide<T> modulus) {
  return {compose(u, tau, u), energy, modulus};
}

}  // namespace detail

/// Stress of the fluid at volume ratio j.
template <int D, class T>
Response<D, T> fluid_response(const Material& mat, Wide<T> j) {
  using W = Wide<T>;
  const W k(mat.lambda), i = W(1) / max(j, W(kLeastVolume)), i2 = i * i, i6 = i2 * i2 * i2;
  const W p = k * W(1.0 / 7) * (i6 * i - W(1));
  // The integral of -p dJ from 1.
  const W energy = k * W(1.0 / 7) * ((i6 - W(1)) * W(1.0 / 6) + j - W(1));
  return {detail::isotropic<D, T>(-p * j), energy, max(k, k * i6)};
}

/// Stress of the neo-Hookean solid, which needs no principal axes: tau = mu (F F^T - 1) + lambda ln J.
template <int D, class T>
Response<D, T> neo_hookean_response(const Material& mat, const Square<D, T>& f) {
  using W = Wide<T>;
  const W mu(mat.mu), lambda(mat.lambda), one(1), half(0.5);
  const W l = log(max(determinant(f), W(kLeastVolume)));
  Response<D, T> out;
  W squares = W::zero(), widest = one;
  for (int r = 0; r < D; ++r) {
    W row = W::zero();
    for (int c = 0; c < D; ++c) {
      W b = f(r, 0) * f(c, 0);
      for (int k = 1; k < D; ++k) b = madd(f(r, k), f(c, k), b);
      if (r == c) squares += b;
      row += abs(b);
      out.tau(r, c) = r == c ? madd(mu, b - one, lambda * l) : mu * b;
    }
    // Gershgorin: no eigenvalue of F F^T, a squared stretch, exceeds the largest row sum.
    widest = max(widest, row);
  }
  out.energy = half * mu * (squares - W(D)) - mu * l + half * lambda * l * l;
  out.modulus = madd(W(2), mu, lambda * (one + abs(l))) * widest;
  return out;
}

/// Stress of the corotated solid and of snow, from the nearest rotation R: tau = 2 mu (F - R) F^T + lambda
/// (J - 1) J.
template <int D, class T>
Response<D, T> corotated_response(const Material& mat, const Square<D, T>& f, Wide<T> plastic) {
  using W = Wide<T>;
  W mu(mat.mu), lambda(mat.lambda);
  if (mat.law == Law::snow) {
    const W h = hardening(mat, plastic);
    mu *= h, lambda *= h;
  }
  const W one(1), half(0.5), j = determinant(f), p = lambda * (j - one) * j;
  Square<D, T> away = nearest_rotation(f);
  W squares = W::zero(), widest = one;
  for (int k = 0; k < D * D; ++k) {
    away.m[k] = f.m[k] - away.m[k];
    squares = madd(away.m[k], away.m[k], squares);
  }
  Response<D, T> out;
  for (int r = 0; r < D; ++r) {
    W row = W::zero();
    for (int c = 0; c < D; ++c) {
      W t = away(r, 0) * f(c, 0), b = f(r, 0) * f(c, 0);
      for (int k = 1; k < D; ++k) t = madd(away(r, k), f(c, k), t), b = madd(f(r, k), f(c, k), b);
      out.tau(r, c) = r == c ? madd(mu + mu, t, p) : (mu + mu) * t;
      row += abs(b);
    }
    // Gershgorin, as above.
    widest = max(widest, row);
  }
  out.energy = madd(mu, squares, half * lambda * (j - one) * (j - one));
  out.modulus = madd(W(2), mu, lambda) * widest;
  return out;
}

/// From singular values. `plastic` is Jp for snow and unused by other laws.
template <int D, class T>
Response<D, T> solid_response(const Material& mat, const Svd<D, T>& d, Wide<T> plastic) {
  using W = Wide<T>;
  W mu(mat.mu), lambda(mat.lambda), tau[D];
  const W one(1), half(0.5);
  const W widening = max(one, d.s[0] * d.s[0]);
  if (mat.law == Law::sand || mat.law == Law::foam) {
    W e[D], trace = W::zero(), norm2 = W::zero();
    for (int k = 0; k < D; ++k) {
      e[k] = log(max(d.s[k], W(kLeastVolume)));
      trace += e[k], norm2 = madd(e[k], e[k], norm2);
    }
    for (int k = 0; k < D; ++k) tau[k] = madd(mu + mu, e[k], lambda * trace);
    return detail::principal(d.u, tau, madd(mu, norm2, half * lambda * trace * trace),
                             madd(W(2), mu, lambda) * widening);
  }
  W j = d.s[0];
  for (int k = 1; k < D; ++k) j *= d.s[k];
  if (mat.law == Law::snow) {
    const W h = hardening(mat, plastic);
    mu *= h, lambda *= h;
  }
  W away = W::zero();
  for (int k = 0; k < D; ++k) {
    const W x = d.s[k] - one;
    away = madd(x, x, away);
    tau[k] = madd((mu + mu) * x, d.s[k], lambda * (j - one) * j);
  }
  return detail::principal(d.u, tau, madd(mu, away, half * lambda * (j - one) * (j - one)),
                           madd(W(2), mu, lambda) * widening);
}

/// Stress of any isotropic energy (J/m^3), given with its first and second derivatives by each singular value
/// (all positive): tau_k = s_k dpsi/ds_k. The modulus is the largest among the stretches and the shears
/// between two axes; the stiffness of a shear is the difference of the derivatives over that of the values,
/// or their sum over the sum of the values (Stomakhin, Howes, Schroeder, Teran 2012, section 4).
template <int D, class T>
Response<D, T> principal_response(const Svd<D, T>& d, Wide<T> energy, const Wide<T>* slope,
                                  const Wide<T>* bend) {
  using W = Wide<T>;
  W tau[D], stiffest = W::zero(), widest = W(1);
  for (int k = 0; k < D; ++k) {
    tau[k] = d.s[k] * slope[k];
    stiffest = max(stiffest, abs(bend[k])), widest = max(widest, d.s[k] * d.s[k]);
    for (int i = 0; i < k; ++i) {
      const W apart = abs(d.s[k] - d.s[i]);
      const auto differ = apart > W(1e-2);
      stiffest = max(stiffest, abs(slope[k] + slope[i]) / (d.s[k] + d.s[i]));
      stiffest =
          max(stiffest, select(differ, abs(slope[k] - slope[i]) / select(differ, apart, W(1)), W::zero()));
    }
  }
  return detail::principal(d.u, tau, energy, stiffest * widest);
}

/// For any law but `elastic`, from the given deformation and volume ratio.
template <int D, class T>
Response<D, T> response(const Material& mat, const Square<D, T>& f, Wide<T> j, Wide<T> plastic) {
  if (mat.law == Law::fluid) return fluid_response<D, T>(mat, j);
  if (mat.law == Law::neo_hookean) return neo_hookean_response(mat, f);
  if (mat.law == Law::corotated || mat.law == Law::snow) return corotated_response(mat, f, plastic);
  return solid_response(mat, svd(f), plastic);
}

/// Plastic flow of the elastic singular values d.s; `plastic` is Jp of snow, the volume correction of sand,
/// the plastic strain of foam. For snow, sand and foam only.
template <int D, class T>
void return_map(const Material& mat, Svd<D, T>& d, Wide<T>& plastic) {
  using W = Wide<T>;
  const W one(1), zero = W::zero();
  if (mat.law == Law::snow) {
    W before = one, after = one;
    for (int k = 0; k < D; ++k) {
      before *= d.s[k];
      d.s[k] = min(max(d.s[k], W(1 - mat.compression)), W(1 + mat.stretch));
      after *= d.s[k];
    }
    // Beyond these bounds neither the hardening nor the appearance changes.
    plastic = min(max(plastic * before / after, W(0.1)), W(20));
    return;
  }
  W e[D], trace = zero, norm2 = zero;
  for (int k = 0; k < D; ++k) {
    e[k] = log(max(d.s[k], W(kLeastVolume)));
    if (mat.law == Law::sand) e[k] += plastic * W(1.0 / D);
    trace += e[k];
  }
  const W mean = trace * W(1.0 / D);
  for (int k = 0; k < D; ++k) {
    const W dev = e[k] - mean;
    norm2 = madd(dev, dev, norm2);
  }
  const W norm = sqrt(norm2), safe = max(norm, W(1e-30));
  if (mat.law == Law::sand) {
    // Klar et al. 2016, section 7.3: beyond the tip, to zero; outside the cone, onto it.
    const W excess = norm + W((D * mat.lambda + 2 * mat.mu) / (2 * mat.mu) * mat.cone) * trace;
    const auto tip = trace > zero;
    const W keep = select(tip, zero, one - max(excess, zero) / safe);
    const W scale = select(norm > W(1e-30), keep, select(tip, zero, one));
    for (int k = 0; k < D; ++k) {
      const W onto = madd(scale, e[k] - mean, mean);
      d.s[k] = exp(select(tip, zero, onto));
    }
    plastic = select(tip, trace, zero);
    return;
  }
  // sqrt(2/3) sigma_y / (2 mu): the radius of the cylinder in strains.
  const W radius(0.81649658092772603 * mat.yield / (2 * mat.mu));
  const W beyond = max(norm - radius, zero), scale = one - beyond / safe;
  for (int k = 0; k < D; ++k) d.s[k] = exp(madd(scale, e[k] - mean, mean));
  plastic += beyond * W(0.81649658092772603);
}

}  // namespace truestep::mpm
