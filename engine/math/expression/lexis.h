// Characters, names and functions of expressions; shared by names.cc and reader*.cc.
#pragma once
#include <string_view>

#include "engine/math/expression/operator.h"

namespace truestep::lexis {

using O = Operator;

inline bool letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
inline bool digit(char c) {
  return c >= '0' && c <= '9';
}
inline bool blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

/// Length of the name that starts at `at`, including primes; 0 if there is none.
inline size_t name_length(std::string_view text, size_t at) {
  size_t end = at;
  if (end == text.size() || !letter(text[end])) return 0;
  while (end < text.size() && (letter(text[end]) || digit(text[end]))) ++end;
  while (end < text.size() && text[end] == '\'') ++end;
  return end - at;
}

struct ExpressionFunction {
  std::string_view name;
  O op;
  int arguments;
};
inline constexpr ExpressionFunction kExpressionFunctions[] = {
    {"sqrt", O::sqrt, 1}, {"abs", O::abs, 1},   {"sign", O::sign, 1}, {"floor", O::floor, 1},
    {"exp", O::exp, 1},   {"log", O::log, 1},   {"sin", O::sin, 1},   {"cos", O::cos, 1},
    {"tan", O::tan, 1},   {"asin", O::asin, 1}, {"acos", O::acos, 1}, {"atan", O::atan, 1},
    {"pow", O::power, 2}, {"min", O::min, 2},   {"max", O::max, 2},   {"atan2", O::atan2, 2},
};

inline const ExpressionFunction* find_function(std::string_view name) {
  for (const ExpressionFunction& f : kExpressionFunctions) {
    if (f.name == name) return &f;
  }
  return nullptr;
}

}  // namespace truestep::lexis
