// Arithmetic expressions that users write, compiled to a small stack program and run over many rows at once:
//   + - * / ^ (right associative)  unary -  < <= > >= == !=  && ||  c ? a : b
//   sqrt abs sign floor exp log sin cos tan asin acos atan atan2 pow min max, the constant pi
// Deterministic: math/trig.h instead of libm, small integer powers by multiplication. No assignment, no
// strings, no loops; length, depth and size are bounded. Immutable once parsed, so any thread may run it.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace truestep {

/// Why a text is no expression, and the character (from 0) where that shows.
struct ExpressionFault {
  size_t position = 0;
  std::string message;
};

class Expression {
 public:
  static constexpr size_t kMaxLength = 1000, kMaxInstructions = 512, kMaxStack = 32;

  /// Throws ExpressionFault. Variables are numbered in the order of their names; constants are folded in.
  static Expression parse(std::string_view text, std::span<const std::string> variables,
                          std::span<const std::pair<std::string, double>> constants);

  /// Row i of a variable is data[i * stride]; stride 0: the same for all.
  struct Column {
    const double* data = nullptr;
    size_t stride = 0;
  };
  /// out[i] for rows [begin, end) of the columns, i from `begin`.
  void evaluate(std::span<const Column> variables, double* out, size_t begin, size_t end) const;
  /// True when the variable of that number occurs.
  bool uses(size_t variable) const;

 private:
  friend class ExpressionParser;
  enum class Op : uint8_t {
    constant,
    variable,
    negate,
    add,
    subtract,
    multiply,
    divide,
    power,
    integer_power,
    less,
    less_equal,
    greater,
    greater_equal,
    equal,
    not_equal,
    both,
    either,
    choose,
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
    atan2,
    min,
    max,
  };
  struct Instruction {
    Op op;
    int32_t index = 0;  ///< variable, or exponent
    double value = 0;
  };
  void run(std::span<const Column> variables, double* out, size_t begin, size_t lanes) const;
  std::vector<Instruction> code_;
};

}  // namespace truestep
