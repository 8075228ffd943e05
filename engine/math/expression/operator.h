// The operators of user-written expressions and their effect on numbers. Folding, the evaluation of one point
// and that of many rows all go through `apply`, so they agree to the bit. Powers with small integer or
// half-integer exponents are not operators: the graph writes them as products and a square root.
#pragma once
#include <cmath>
#include <cstdint>

#include "engine/math/trig.h"

namespace truestep {

enum class Operator : uint8_t {
  constant,
  variable,
  fault,  ///< a value that does not exist (x[-1]); an error unless a condition excludes it
  negate,
  sqrt,
  abs,
  sign,
  floor,
  exp,
  log,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  add,
  subtract,
  multiply,
  divide,
  power,
  atan2,
  min,
  max,
  less,
  less_equal,
  equal,
  not_equal,
  both,
  either,
  choose,
  // Made from a product and a sum by a program's peephole pass; rounded twice, never fused.
  multiply_add,       ///< a b + c
  multiply_subtract,  ///< a b - c
  subtract_multiply,  ///< c - a b
};

/// Number of operands; 0 for anything that is not an operation.
constexpr int arity(Operator op) {
  if (op < Operator::negate) return 0;
  if (op < Operator::add) return 1;
  return op < Operator::choose ? 2 : 3;
}

template <Operator op>
inline double apply(double a, double b, double c) {
  using O = Operator;
  if constexpr (op == O::negate) return -a;
  if constexpr (op == O::sqrt) return std::sqrt(a);
  if constexpr (op == O::abs) return std::fabs(a);
  if constexpr (op == O::sign) return a > 0 ? 1.0 : a < 0 ? -1.0 : 0.0;
  if constexpr (op == O::floor) return std::floor(a);
  if constexpr (op == O::exp) return trig::exp(a);
  if constexpr (op == O::log) return trig::log(a);
  if constexpr (op == O::sin) return trig::sin(a);
  if constexpr (op == O::cos) return trig::cos(a);
  if constexpr (op == O::tan) return trig::tan(a);
  if constexpr (op == O::asin) return trig::asin(a);
  if constexpr (op == O::acos) return trig::acos(a);
  if constexpr (op == O::atan) return trig::atan(a);
  if constexpr (op == O::add) return a + b;
  if constexpr (op == O::subtract) return a - b;
  if constexpr (op == O::multiply) return a * b;
  if constexpr (op == O::divide) return a / b;
  if constexpr (op == O::power) return trig::pow(a, b);
  if constexpr (op == O::atan2) return trig::atan2(a, b);
  if constexpr (op == O::min) return b < a ? b : a;
  if constexpr (op == O::max) return b > a ? b : a;
  if constexpr (op == O::less) return a < b ? 1.0 : 0.0;
  if constexpr (op == O::less_equal) return a <= b ? 1.0 : 0.0;
  if constexpr (op == O::equal) return a == b ? 1.0 : 0.0;
  if constexpr (op == O::not_equal) return a != b ? 1.0 : 0.0;
  if constexpr (op == O::both) return a != 0 && b != 0 ? 1.0 : 0.0;
  if constexpr (op == O::either) return a != 0 || b != 0 ? 1.0 : 0.0;
  if constexpr (op == O::choose) return a != 0 ? b : c;
  if constexpr (op == O::multiply_add) return a * b + c;
  if constexpr (op == O::multiply_subtract) return a * b - c;
  if constexpr (op == O::subtract_multiply) return c - a * b;
  return a;
}

/// Calls f.template operator()<op>() for an operation that is known only at run time.
template <class F>
[[gnu::always_inline]] inline decltype(auto) dispatch(Operator op, F&& f) {
  using O = Operator;
  switch (op) {
#define TRUESTEP_CASE(name) \
  case O::name:             \
    return f.template operator()<O::name>();
    TRUESTEP_CASE(negate)
    TRUESTEP_CASE(sqrt)
    TRUESTEP_CASE(abs)
    TRUESTEP_CASE(sign)
    TRUESTEP_CASE(floor)
    TRUESTEP_CASE(exp)
    TRUESTEP_CASE(log)
    TRUESTEP_CASE(sin)
    TRUESTEP_CASE(cos)
    TRUESTEP_CASE(tan)
    TRUESTEP_CASE(asin)
    TRUESTEP_CASE(acos)
    TRUESTEP_CASE(atan)
    TRUESTEP_CASE(add)
    TRUESTEP_CASE(subtract)
    TRUESTEP_CASE(multiply)
    TRUESTEP_CASE(divide)
    TRUESTEP_CASE(power)
    TRUESTEP_CASE(atan2)
    TRUESTEP_CASE(min)
    TRUESTEP_CASE(max)
    TRUESTEP_CASE(less)
    TRUESTEP_CASE(less_equal)
    TRUESTEP_CASE(equal)
    TRUESTEP_CASE(not_equal)
    TRUESTEP_CASE(both)
    TRUESTEP_CASE(either)
    TRUESTEP_CASE(choose)
    TRUESTEP_CASE(multiply_add)
    TRUESTEP_CASE(multiply_subtract)
    TRUESTEP_CASE(subtract_multiply)
#undef TRUESTEP_CASE
    default:
      return f.template operator()<O::constant>();
  }
}

/// The same for an operation that is known only at run time.
inline double apply(Operator op, double a, double b, double c) {
  return dispatch(op, [=]<Operator known>() { return apply<known>(a, b, c); });
}

}  // namespace truestep
