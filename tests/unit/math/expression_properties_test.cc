// Random texts: one point, many rows and the oracle agree to the bit; the derivative is the limit of finite
// differences; random bytes are refused and never crash.
#include <gtest/gtest.h>

#include <random>

#include "engine/math/trig_rows.h"
#include "tests/support/compiled_expressions.h"
#include "tests/support/expression_oracle.h"

namespace truestep::test {
namespace {

class RandomText {
 public:
  enum class Kind { any, smooth };
  RandomText(uint64_t seed, Kind kind) : random_(seed), kind_(kind) {}

  std::string text(int depth) {
    static const char* kAll[] = {"sqrt(", "abs(", "sign(", "floor(", "exp(",  "log(",
                                 "sin(",  "cos(", "tan(",  "asin(",  "acos(", "atan("};
    static const char* kSmooth[] = {"sin(", "cos(", "atan(", "exp(0.1*"};
    static const char* kPowers[] = {"2", "3", "0.5", "1.5", "-1", "-2.5", "5", "0", "64"};
    static const char* kCompare[] = {"<", "<=", ">", ">=", "==", "!=", "&&", "||"};
    if (depth == 0) return leaf();
    const bool smooth = kind_ == Kind::smooth;
    switch (pick(smooth ? 7 : 11)) {
      case 0:
        return "(" + text(depth - 1) + " + " + text(depth - 1) + ")";
      case 1:
        return "(" + text(depth - 1) + " - " + text(depth - 1) + ")";
      case 2:
        return text(depth - 1) + " * " + text(depth - 1);
      case 3:
        return smooth ? "(" + text(depth - 1) + ") / (2 + (" + text(depth - 1) + ")^2)"
                      : "(" + text(depth - 1) + " / " + text(depth - 1) + ")";
      case 4:
        return smooth ? "(1 + (" + text(depth - 1) + ")^2)^" + (pick(2) ? "1.5" : "-0.5")
                      : "(" + text(depth - 1) + ")^" + kPowers[pick(9)];
      case 5:
        return (smooth ? kSmooth[pick(4)] : kAll[pick(12)]) + text(depth - 1) + ")";
      case 6:
        return "-(" + text(depth - 1) + ")";
      case 7:
        return "(" + text(depth - 1) + " " + kCompare[pick(8)] + " " + text(depth - 1) + ")";
      case 8:
        return "(" + text(depth - 1) + " ? " + text(depth - 1) + " : " + text(depth - 1) + ")";
      case 9:
        return (pick(2) ? "min(" : "max(") + text(depth - 1) + ", " + text(depth - 1) + ")";
      default:
        return "atan2(" + text(depth - 1) + ", " + text(depth - 1) + ")";
    }
  }
  double number() {
    static constexpr double kSpecial[] = {0, -0.0, 1, -1, 1e300, 5e-324, 0.5, 2, HUGE_VAL, NAN, 1e12, 0x1p30};
    return pick(4) ? std::uniform_real_distribution<>(-3, 3)(random_) : kSpecial[pick(12)];
  }
  double moderate() { return std::uniform_real_distribution<>(-1, 1)(random_); }
  size_t pick(size_t n) { return random_() % n; }

 private:
  std::string leaf() {
    static const char* kNumbers[] = {"0", "1", "2", "0.5", "3", "8", "1e-3", "pi"};
    static const char* kNames[] = {"x", "y", "z", "w"};
    return pick(4) ? kNames[pick(4)] : kNumbers[pick(8)];
  }
  std::mt19937_64 random_;
  Kind kind_;
};

TEST(ExpressionProperties, PointRowsAndOracleAgreeToTheBit) {
  const std::vector<std::string> names = {"x", "y", "z", "w"};
  size_t finite = 0;
  for (uint64_t seed = 0; seed < 300; ++seed) {
    RandomText random(seed, RandomText::Kind::any);
    CompiledExpressions e(names);
    std::vector<std::string> texts;
    for (size_t k = 0; k < 1 + random.pick(9); ++k) {
      texts.push_back(random.text(static_cast<int>(1 + random.pick(4))));
      e.root(texts.back());
    }
    const size_t rows = 1 + random.pick(150);
    std::vector<double> values(4 * rows);
    for (double& v : values) v = random.number();
    const auto all = e.rows(values);
    for (size_t i = 0; i < rows; i += 1 + rows / 5) {
      const std::vector<double> one(values.begin() + static_cast<long>(4 * i),
                                    values.begin() + static_cast<long>(4 * i + 4));
      const auto point = e.at(one);
      for (size_t k = 0; k < texts.size(); ++k) {
        ExpressionOracle oracle(
            texts[k],
            {{"x", one[0]}, {"y", one[1]}, {"z", one[2]}, {"w", one[3]}, {"pi", 3.141592653589793}});
        const double expected = oracle.value();
        ASSERT_TRUE(same_bits(point[k], expected)) << texts[k] << ": " << point[k] << " and " << expected;
        ASSERT_TRUE(same_bits(all[i * texts.size() + k], expected)) << texts[k];
        finite += std::isfinite(expected);
      }
    }
  }
  EXPECT_GT(finite, 2000u);  // the texts are not all NaN
}

TEST(ExpressionProperties, AlikeComponentsInLanesHaveTheBitsOfEachAlone) {
  // Sizes around the width of a lane, with adjacent, scattered and shared operands.
  for (const size_t n : {1, 2, 3, 4, 5, 7, 8, 9, 31}) {
    CompiledExpressions e({"k"});
    e.array("x", n);
    e.array("y", n);
    std::vector<double> values(1 + 2 * n);
    std::mt19937_64 random(n);
    for (double& v : values) v = std::uniform_real_distribution<>(0.1, 3)(random);
    const std::string family =
        "sum(j != i, k * (x[j] - x[i]) / ((x[j] - x[i])^2 + (y[j] - y[(7 * i) % len(y)])^2)^1.5) "
        "- sqrt(y[i]) * x[0] + sin(x[i])";
    std::vector<double> alone;
    for (size_t i = 0; i < n; ++i) {
      e.roots.clear();
      e.root(family, {{"i", static_cast<int64_t>(i)}});
      alone.push_back(e.at(values)[0]);
    }
    e.roots.clear();
    for (size_t i = 0; i < n; ++i) e.root(family, {{"i", static_cast<int64_t>(i)}});
    const auto together = e.at(values);
    for (size_t i = 0; i < n; ++i) EXPECT_TRUE(same_bits(together[i], alone[i])) << n << " " << i;
  }
}

TEST(ExpressionProperties, DerivativeIsTheLimitOfDifferences) {
  size_t compared = 0, wrong_sign = 0;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    RandomText random(seed, RandomText::Kind::smooth);
    CompiledExpressions e({"x", "y", "z", "w"});
    e.root(random.text(3));
    std::vector<ExpressionGraph::Partial> partials;
    e.graph.differentiate(e.roots[0], 0, 4, partials);
    for (const auto& p : partials) e.roots.push_back(p.node);
    std::vector<double> at(4);
    for (double& v : at) v = random.moderate();
    const auto exact = e.at(at);
    for (size_t k = 0; k < partials.size(); ++k) {
      const auto variable = static_cast<size_t>(partials[k].variable);
      // Central differences, once extrapolated: error h^4, rounding eps / h.
      const auto difference = [&](double h) {
        auto low = at, high = at;
        low[variable] -= h, high[variable] += h;
        return (e.at(high)[0] - e.at(low)[0]) / (2 * h);
      };
      const double numeric = (4 * difference(1e-3) - difference(2e-3)) / 3;
      const double scale = 1 + std::fabs(exact[0]) + std::fabs(exact[1 + k]);
      EXPECT_NEAR(exact[1 + k], numeric, 1e-7 * scale) << seed;
      wrong_sign += std::fabs(-exact[1 + k] - numeric) > 1e-7 * scale;
      ++compared;
    }
  }
  EXPECT_GT(compared, 200u);
  EXPECT_GT(wrong_sign, compared / 2);  // the control: a lost sign would be seen
}

// By every operand, those of functions that random texts leave out because they have kinks or ends, too.
TEST(ExpressionProperties, EveryFunctionHasItsDerivative) {
  for (const char* text : {"sqrt(x)",
                           "abs(x - y)",
                           "exp(x * y)",
                           "log(x)",
                           "sin(x)",
                           "cos(x)",
                           "tan(x)",
                           "asin(x)",
                           "acos(x)",
                           "atan(x)",
                           "x / y",
                           "x ^ y",
                           "y ^ 3",
                           "x ^ -1.5",
                           "atan2(x, y)",
                           "atan2(-x, y - 1)",
                           "min(x, y)",
                           "max(x, y)",
                           "x < y ? x * y : x / y",
                           "x > y ? x * y : x / y",
                           "-x + y"}) {
    CompiledExpressions e({"x", "y"});
    e.root(text);
    std::vector<ExpressionGraph::Partial> partials;
    e.graph.differentiate(e.roots[0], 0, 2, partials);
    for (const auto& p : partials) e.roots.push_back(p.node);
    const std::vector<double> at{0.3, 0.7};
    const auto exact = e.at(at);
    for (size_t variable = 0; variable < 2; ++variable) {
      double sum = 0;
      for (size_t k = 0; k < partials.size(); ++k) {
        if (static_cast<size_t>(partials[k].variable) == variable) sum += exact[1 + k];
      }
      auto low = at, high = at;
      low[variable] -= 1e-5, high[variable] += 1e-5;
      EXPECT_NEAR(sum, (e.at(high)[0] - e.at(low)[0]) / 2e-5, 1e-8 * (1 + std::fabs(sum)))
          << text << " by " << variable;
    }
  }
}

TEST(ExpressionProperties, RandomBytesAreRefusedOrCompiled) {
  std::mt19937_64 random(5);
  const std::string alphabet = "xyzw m[]()+-*/^<>=!&|?:,.0123456789 sumijen'len\"\\\n\xc3";
  for (int k = 0; k < 20000; ++k) {
    std::string text(random() % 24, ' ');
    for (char& c : text) c = alphabet[random() % alphabet.size()];
    CompiledExpressions e({"x", "y", "z", "w"});
    e.array("m", 3);
    try {
      e.root(text);
      e.at(std::vector<double>(7, 0.5));
      e.rows(std::vector<double>(7, 0.5));
    } catch (const ExpressionFault& fault) {
      EXPECT_FALSE(describe(fault, text).empty());
    }
  }
}

TEST(ExpressionProperties, SineAndCosineOfRowsHaveTheBitsOfOne) {
  std::mt19937_64 random(9);
  for (const double size : {1e-300, 1e-3, 0.7853981633974484, 1.0, 100.0, 1e9}) {
    std::vector<double> x(1003), s(x.size()), c(x.size());
    for (double& v : x) v = std::uniform_real_distribution<>(-size, size)(random);
    x[0] = 0.7853981633974483, x[1] = -x[0], x[2] = std::nextafter(x[0], 1), x[3] = -0.0;
    if (size == 1.0) x[4] = 1e300, x[5] = NAN;
    trig::sin_rows(x.data(), s.data(), x.size());
    trig::cos_rows(x.data(), c.data(), x.size());
    for (size_t k = 0; k < x.size(); ++k) {
      EXPECT_TRUE(same_bits(s[k], trig::sin(x[k]))) << x[k];
      EXPECT_TRUE(same_bits(c[k], trig::cos(x[k]))) << x[k];
    }
  }
}

}  // namespace
}  // namespace truestep::test
