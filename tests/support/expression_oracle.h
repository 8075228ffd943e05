// Evaluates the text of an expression for one set of values while parsing it: no graph, no folding, no
// sharing. Compiled expressions are compared with it to the bit. Exponents must be number literals.
#pragma once
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>

#include "engine/math/trig.h"

namespace truestep::test {

class ExpressionOracle {
 public:
  ExpressionOracle(std::string text, std::map<std::string, double> values)
      : text_(std::move(text)), values_(std::move(values)) {}

  double value() {
    at_ = 0;
    return choice();
  }

  /// a^b as documented: integers by repeated multiplication, half-integers with a square root, otherwise pow.
  static double power(double a, double b) {
    const double n = std::fabs(b);
    if (n > 64 || 2 * n != std::floor(2 * n)) return trig::pow(a, b);
    double result = 1, square = a;
    for (auto k = static_cast<unsigned>(n); k > 0; k >>= 1) {
      if (k & 1) result *= square;
      square *= square;
    }
    if (n != std::floor(n)) result = n < 1 ? std::sqrt(a) : result * std::sqrt(a);
    return b < 0 ? 1 / result : result;
  }

 private:
  bool take(const std::string& token) {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    if (text_.compare(at_, token.size(), token) != 0) return false;
    at_ += token.size();
    return true;
  }
  double choice() {
    const double c = either();
    if (!take("?")) return c;
    const double a = choice();
    take(":");
    const double b = choice();
    return c != 0 ? a : b;
  }
  double either() {
    double a = both();
    while (take("||")) {
      const double b = both();
      a = a != 0 || b != 0;
    }
    return a;
  }
  double both() {
    double a = compare();
    while (take("&&")) {
      const double b = compare();
      a = a != 0 && b != 0;
    }
    return a;
  }
  double compare() {
    const double a = sum();
    if (take("<=")) return a <= sum();
    if (take(">=")) return a >= sum();
    if (take("==")) return a == sum();
    if (take("!=")) return a != sum();
    if (take("<")) return a < sum();
    if (take(">")) return a > sum();
    return a;
  }
  double sum() {
    double a = product();
    while (true) {
      if (take("+")) {
        a = a + product();
      } else if (take("-")) {
        a = a - product();
      } else {
        return a;
      }
    }
  }
  double product() {
    double a = sign();
    while (true) {
      if (take("*")) {
        a = a * sign();
      } else if (take("/")) {
        a = a / sign();
      } else {
        return a;
      }
    }
  }
  double sign() { return take("-") ? -sign() : raised(); }
  double raised() {
    const double a = atom();
    return take("^") ? power(a, sign()) : a;
  }
  double atom() {
    if (take("(")) {
      const double a = choice();
      take(")");
      return a;
    }
    take("");  // blanks
    if (std::isdigit(static_cast<unsigned char>(text_[at_]))) {
      char* end;
      const double v = std::strtod(text_.c_str() + at_, &end);
      at_ = static_cast<size_t>(end - text_.c_str());
      return v;
    }
    const size_t start = at_;
    while (at_ < text_.size() && std::isalnum(static_cast<unsigned char>(text_[at_]))) ++at_;
    const std::string name = text_.substr(start, at_ - start);
    if (const auto v = values_.find(name); v != values_.end()) return v->second;
    take("(");
    const double a = choice();
    const double b = take(",") ? choice() : 0;
    take(")");
    return call(name, a, b);
  }
  static double call(const std::string& f, double a, double b) {
    if (f == "sqrt") return std::sqrt(a);
    if (f == "abs") return std::fabs(a);
    if (f == "sign") return a > 0 ? 1 : a < 0 ? -1 : 0;
    if (f == "floor") return std::floor(a);
    if (f == "exp") return trig::exp(a);
    if (f == "log") return trig::log(a);
    if (f == "sin") return trig::sin(a);
    if (f == "cos") return trig::cos(a);
    if (f == "tan") return trig::tan(a);
    if (f == "asin") return trig::asin(a);
    if (f == "acos") return trig::acos(a);
    if (f == "atan") return trig::atan(a);
    if (f == "atan2") return trig::atan2(a, b);
    if (f == "min") return b < a ? b : a;
    if (f == "max") return b > a ? b : a;
    throw std::runtime_error("the oracle knows no " + f);
  }

  std::string text_;
  std::map<std::string, double> values_;
  size_t at_ = 0;
};

}  // namespace truestep::test
