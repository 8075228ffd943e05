// w and s of the smoothing kernels (smoothing.h), of any number of lanes at once.
#pragma once
#include <cstdint>

namespace truestep::sph {

enum class Smoothing : uint8_t { cubic, wendland_c2, wendland_c4, poly6_spiky };

/// w and s of q in [0, 1], for lanes W of numbers T.
template <class W>
struct SmoothingLanes {
  W w, s;
};

template <Smoothing K, class T, class W>
inline SmoothingLanes<W> smoothing_of(const W& q) {
  const auto real = [](double x) { return W::all(static_cast<T>(x)); };
  const W u = real(1) - q, u2 = u * u;
  if constexpr (K == Smoothing::cubic) {
    const W inner_w = madd(real(6) * q * q, q - real(1), real(1));
    const W inner_s = madd(real(18), q, real(-12));
    const W outer_w = real(2) * u2 * u;
    // Used only above a half, where q is far from 0.
    const W outer_s = real(-6) * u2 / max(q, real(0.5));
    const auto near = q < real(0.5);
    return {select(near, inner_w, outer_w), select(near, inner_s, outer_s)};
  } else if constexpr (K == Smoothing::wendland_c2) {
    return {u2 * u2 * madd(real(4), q, real(1)), real(-20) * u2 * u};
  } else if constexpr (K == Smoothing::poly6_spiky) {
    const W p = real(1) - q * q;
    // The gradient's size tends to 3 at q = 0, where it has no direction.
    return {p * p * p, real(-3) * u2 / max(q, real(1e-3))};
  } else {
    const W u4 = u2 * u2;
    const W p = madd(madd(real(35.0 / 3), q, real(6)), q, real(1));
    return {u4 * u2 * p, real(-56.0 / 3) * u4 * u * madd(real(5), q, real(1))};
  }
}

}  // namespace truestep::sph
