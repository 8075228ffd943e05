#include "engine/math/expression.h"

#include <gtest/gtest.h>

#include <cmath>

namespace truestep {
namespace {

const std::vector<std::string> kNames = {"x", "y", "t"};

double value(const char* text, double x = 2, double y = -3, double t = 0.5) {
  const std::vector<std::pair<std::string, double>> constants = {{"k", 10}};
  const auto e = Expression::parse(text, kNames, constants);
  const Expression::Column columns[] = {{&x, 1}, {&y, 1}, {&t, 0}};
  double out = 0;
  e.evaluate(columns, &out, 0, 1);
  return out;
}

TEST(Expression, PrecedenceAndAssociation) {
  EXPECT_EQ(value("1 + 2 * 3"), 7);
  EXPECT_EQ(value("2 ^ 3 ^ 2"), 512);
  EXPECT_EQ(value("-x ^ 2"), -4);
  EXPECT_EQ(value("x ^ -2"), 0.25);
  EXPECT_EQ(value("8 / 4 / 2"), 1);
  EXPECT_EQ(value("5 - 3 - 1"), 1);
  EXPECT_EQ(value("(1 + 2) * (x - y)"), 15);
  EXPECT_EQ(value("1 < 2 && 3 > 4 || x == 2"), 1);
  EXPECT_EQ(value("x > 0 ? k : -k"), 10);
  EXPECT_EQ(value("y > 0 ? 1 : y < -5 ? 2 : 3"), 3);
  EXPECT_EQ(value("1.5e1 + .5"), 15.5);
}

TEST(Expression, FunctionsAndConstants) {
  EXPECT_NEAR(value("sin(pi / 6)"), 0.5, 1e-16);
  EXPECT_EQ(value("sqrt(x * x + y ^ 2)"), std::sqrt(13.0));
  EXPECT_EQ(value("max(x, y) + min(x, y) + abs(y) + sign(y) + floor(2.7)"), -1 + 3 - 1 + 2);
  EXPECT_NEAR(value("exp(log(7)) + pow(2, 0.5) + atan2(1, 1)"), 7 + std::sqrt(2) + std::atan(1.0), 1e-14);
  EXPECT_EQ(value("pow(x, 3)"), 8);
}

TEST(Expression, ManyRowsWithStrides) {
  std::vector<double> xyz(3 * 1000), out(1000);
  for (size_t i = 0; i < xyz.size(); ++i) xyz[i] = 0.001 * static_cast<double>(i);
  const double t = 2;
  const auto e = Expression::parse("x * y + t", kNames, {});
  const Expression::Column columns[] = {{xyz.data(), 3}, {xyz.data() + 1, 3}, {&t, 0}};
  e.evaluate(columns, out.data(), 0, 1000);
  for (size_t i = 0; i < 1000; ++i) EXPECT_EQ(out[i], xyz[3 * i] * xyz[3 * i + 1] + 2);
  std::vector<double> part(10);
  e.evaluate(columns, part.data(), 500, 510);
  for (size_t i = 0; i < 10; ++i) EXPECT_EQ(part[i], out[500 + i]);
  EXPECT_TRUE(e.uses(2));
  EXPECT_FALSE(Expression::parse("x", kNames, {}).uses(2));
}

TEST(Expression, MalformedTextsSayWhere) {
  const std::pair<const char*, size_t> bad[] = {
      {"", 0},          {"1 +", 3},    {"x = 3", 2}, {"foo(x)", 0}, {"x + nope", 4}, {"(x", 2},
      {"sin x", 4},     {"max(x)", 5}, {"x y", 2},   {"1e999", 0},  {"x $ y", 2},    {"x ? 1", 5},
      {"sin(x, y)", 5}, {"* x", 0},    {"x; y", 1},  {"\"x\"", 0},  {"x ** y", 3}};
  for (const auto& [text, position] : bad) {
    try {
      Expression::parse(text, kNames, {});
      ADD_FAILURE() << text;
    } catch (const ExpressionFault& fault) {
      EXPECT_EQ(fault.position, position) << text << ": " << fault.message;
      EXPECT_FALSE(fault.message.empty());
    }
  }
}

TEST(Expression, SizeAndDepthAreBounded) {
  EXPECT_THROW(Expression::parse(std::string(1001, '1'), kNames, {}), ExpressionFault);
  EXPECT_THROW(Expression::parse(std::string(400, '(') + "1" + std::string(400, ')'), kNames, {}),
               ExpressionFault);
  EXPECT_THROW(Expression::parse(std::string(900, '-') + "1", kNames, {}), ExpressionFault);
  std::string tower = "1";
  for (int i = 0; i < 40; ++i) tower = "(x+" + tower + ")";
  EXPECT_THROW(Expression::parse(tower, kNames, {}), ExpressionFault);
  std::string chain = "x";
  for (int i = 0; i < 300; ++i) chain += "+x";
  EXPECT_THROW(Expression::parse(chain, kNames, {}), ExpressionFault);
}

}  // namespace
}  // namespace truestep
