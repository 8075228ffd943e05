// 1/sqrt(x) from multiplications alone, with the same bits on every machine (the processors' own estimates
// differ from maker to maker), and three times as fast as a square root and a division. The first guess
// halves and negates the exponent in the number's bits; with e = 1 - x y^2 the root is
//   y (1 - e)^(-1/2) = y (1 + e/2 + 3/8 e^2 + 5/16 e^3 + 35/128 e^4 + ...).
// One pass leaves 5e-7, float's own rounding; doubles take a second one, which leaves a few units of the last
// place.
#pragma once
#include <cstdint>

#include "engine/math/wide.h"

namespace truestep::gravity {

/// 1/sqrt(x), x > 0 and normal; of 0 a large finite number.
inline Wide<float> inverse_root(Wide<float> x) {
  typedef uint32_t Bits __attribute__((vector_size(32)));
  const Wide<float> y{(Wide<float>::Raw)(0x5f375a86u - ((Bits)x.v >> 1))};
  const Wide<float> e = nmadd(x * y, y, Wide<float>(1));
  const Wide<float> a = madd(e, Wide<float>(35.0f / 128), Wide<float>(5.0f / 16));
  const Wide<float> b = madd(e, a, Wide<float>(3.0f / 8));
  return madd(y * e, madd(e, b, Wide<float>(0.5f)), y);
}

inline Wide<double> inverse_root(Wide<double> x) {
  typedef uint64_t Bits __attribute__((vector_size(32)));
  Wide<double> y{(Wide<double>::Raw)(0x5fe6eb50c7b537a9ull - ((Bits)x.v >> 1))};
  Wide<double> e = nmadd(x * y, y, Wide<double>(1));
  const Wide<double> a = madd(e, Wide<double>(35.0 / 128), Wide<double>(5.0 / 16));
  y = madd(y * e, madd(e, madd(e, a, Wide<double>(3.0 / 8)), Wide<double>(0.5)), y);
  // 5e-7 now, so that the square of e is the last term that counts.
  e = nmadd(x * y, y, Wide<double>(1));
  return madd(y * e, madd(e, Wide<double>(3.0 / 8), Wide<double>(0.5)), y);
}

}  // namespace truestep::gravity
