#include "engine/math/expression.h"

#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"

namespace truestep {

namespace {
constexpr size_t kLanes = 64;

/// x^n by squaring; n of either sign.
double integer_power(double x, int n) {
  double result = 1, square = x;
  for (unsigned k = static_cast<unsigned>(n < 0 ? -n : n); k > 0; k >>= 1) {
    if (k & 1) result *= square;
    square *= square;
  }
  return n < 0 ? 1 / result : result;
}
}  // namespace

bool Expression::uses(size_t variable) const {
  return std::any_of(code_.begin(), code_.end(), [variable](const Instruction& i) {
    return i.op == Op::variable && static_cast<size_t>(i.index) == variable;
  });
}

void Expression::evaluate(std::span<const Column> variables, double* out, size_t begin, size_t end) const {
  for (size_t i = begin; i < end; i += kLanes) {
    run(variables, out + (i - begin), i, std::min(kLanes, end - i));
  }
}

void Expression::run(std::span<const Column> variables, double* out, size_t begin, size_t lanes) const {
  double stack[kMaxStack][kLanes];
  size_t top = 0;  // number of values on the stack
  // Lanes beyond `lanes` compute on leftovers; loops of fixed length vectorise.
  const auto unary = [&](auto f) {
    double* a = stack[top - 1];
    for (size_t k = 0; k < lanes; ++k) a[k] = f(a[k]);
  };
  const auto binary = [&](auto f) {
    double *a = stack[top - 2], *b = stack[top - 1];
    for (size_t k = 0; k < lanes; ++k) a[k] = f(a[k], b[k]);
    --top;
  };
  const auto truth = [](bool b) { return b ? 1.0 : 0.0; };
  for (const Instruction& in : code_) {
    switch (in.op) {
      case Op::constant:
        std::fill_n(stack[top++], lanes, in.value);
        break;
      case Op::variable: {
        const Column c = variables[static_cast<size_t>(in.index)];
        double* a = stack[top++];
        for (size_t k = 0; k < lanes; ++k) a[k] = c.data[(begin + k) * c.stride];
        break;
      }
      case Op::negate:
        unary([](double a) { return -a; });
        break;
      case Op::add:
        binary([](double a, double b) { return a + b; });
        break;
      case Op::subtract:
        binary([](double a, double b) { return a - b; });
        break;
      case Op::multiply:
        binary([](double a, double b) { return a * b; });
        break;
      case Op::divide:
        binary([](double a, double b) { return a / b; });
        break;
      case Op::power:
        binary([](double a, double b) { return trig::pow(a, b); });
        break;
      case Op::integer_power:
        unary([n = in.index](double a) { return integer_power(a, n); });
        break;
      case Op::less:
        binary([=](double a, double b) { return truth(a < b); });
        break;
      case Op::less_equal:
        binary([=](double a, double b) { return truth(a <= b); });
        break;
      case Op::greater:
        binary([=](double a, double b) { return truth(a > b); });
        break;
      case Op::greater_equal:
        binary([=](double a, double b) { return truth(a >= b); });
        break;
      case Op::equal:
        binary([=](double a, double b) { return truth(a == b); });
        break;
      case Op::not_equal:
        binary([=](double a, double b) { return truth(a != b); });
        break;
      case Op::both:
        binary([=](double a, double b) { return truth(a != 0 && b != 0); });
        break;
      case Op::either:
        binary([=](double a, double b) { return truth(a != 0 || b != 0); });
        break;
      case Op::choose: {
        double *c = stack[top - 3], *a = stack[top - 2], *b = stack[top - 1];
        for (size_t k = 0; k < lanes; ++k) c[k] = c[k] != 0 ? a[k] : b[k];
        top -= 2;
        break;
      }
      case Op::sqrt:
        unary([](double a) { return std::sqrt(a); });
        break;
      case Op::abs:
        unary([](double a) { return std::fabs(a); });
        break;
      case Op::sign:
        unary([](double a) { return a > 0 ? 1.0 : a < 0 ? -1.0 : 0.0; });
        break;
      case Op::floor:
        unary([](double a) { return std::floor(a); });
        break;
      case Op::exp:
        unary([](double a) { return trig::exp(a); });
        break;
      case Op::log:
        unary([](double a) { return trig::log(a); });
        break;
      case Op::sin:
        unary([](double a) { return trig::sin(a); });
        break;
      case Op::cos:
        unary([](double a) { return trig::cos(a); });
        break;
      case Op::tan:
        unary([](double a) { return trig::tan(a); });
        break;
      case Op::asin:
        unary([](double a) { return trig::asin(a); });
        break;
      case Op::acos:
        unary([](double a) { return trig::acos(a); });
        break;
      case Op::atan:
        unary([](double a) { return trig::atan(a); });
        break;
      case Op::atan2:
        binary([](double a, double b) { return trig::atan2(a, b); });
        break;
      case Op::min:
        binary([](double a, double b) { return b < a ? b : a; });
        break;
      case Op::max:
        binary([](double a, double b) { return b > a ? b : a; });
        break;
    }
  }
  std::copy_n(stack[0], lanes, out);
}

}  // namespace truestep
