#include <gtest/gtest.h>

#include "tests/support/compiled_expressions.h"

namespace truestep::test {
namespace {

double value(const std::string& text, double x = 2, double y = -3, double t = 0.5) {
  CompiledExpressions e({"x", "y", "t"});
  e.names.add_value("k", e.graph.constant(10));
  e.root(text);
  return e.at({x, y, t})[0];
}

ExpressionFault fault_of(const std::string& text) {
  CompiledExpressions e({"x", "y", "vx", "t"});
  e.array("m", 3);
  try {
    e.root(text);
  } catch (const ExpressionFault& fault) {
    return fault;
  }
  ADD_FAILURE() << text << " was accepted";
  return {};
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
  EXPECT_EQ(value("x\n + \t1"), 3);
}

TEST(Expression, FunctionsAndConstants) {
  EXPECT_NEAR(value("sin(pi / 6)"), 0.5, 1e-16);
  EXPECT_EQ(value("sqrt(x * x + y ^ 2)"), std::sqrt(13.0));
  EXPECT_EQ(value("max(x, y) + min(x, y) + abs(y) + sign(y) + floor(2.7)"), -1 + 3 - 1 + 2);
  EXPECT_NEAR(value("exp(log(7)) + pow(2, 0.5) + atan2(1, 1)"), 7 + std::sqrt(2) + std::atan(1.0), 1e-14);
  EXPECT_EQ(value("pow(x, 3)"), 8);
  EXPECT_EQ(value("x ^ 1.5"), 2 * std::sqrt(2.0));
  EXPECT_EQ(value("x ^ -0.5"), 1 / std::sqrt(2.0));
}

TEST(Expression, ManyRowsWithStrides) {
  CompiledExpressions e({"x", "y", "t"});
  e.root("x * y + t");
  const ExpressionRows rows(e.graph, e.roots);
  std::vector<double> xyz(3 * 1000), out(1000);
  for (size_t i = 0; i < xyz.size(); ++i) xyz[i] = 0.001 * static_cast<double>(i);
  const double t = 2;
  const ExpressionRows::Column columns[] = {{xyz.data(), 3}, {xyz.data() + 1, 3}, {&t, 0}};
  const ExpressionRows::Output whole[] = {{out.data()}};
  rows.run(columns, whole, 0, 1000);
  for (size_t i = 0; i < 1000; ++i) EXPECT_EQ(out[i], xyz[3 * i] * xyz[3 * i + 1] + 2);
  std::vector<double> part(20, -1);
  const ExpressionRows::Output some[] = {{part.data(), 2}};
  rows.run(columns, some, 500, 510);
  for (size_t i = 0; i < 10; ++i) EXPECT_EQ(part[2 * i], out[500 + i]);
  EXPECT_EQ(part[1], -1);  // between the strides nothing is touched
  EXPECT_TRUE(rows.uses(2));
}

TEST(Expression, MalformedTextsSayWhere) {
  const std::pair<const char*, size_t> bad[] = {{"", 0},
                                                {"1 +", 3},
                                                {"x = 3", 2},
                                                {"foo(x)", 0},
                                                {"x + nope", 4},
                                                {"(x", 2},
                                                {"sin x", 4},
                                                {"max(x)", 5},
                                                {"x y", 2},
                                                {"1e999", 0},
                                                {"x $ y", 2},
                                                {"x ? 1", 5},
                                                {"sin(x, y)", 5},
                                                {"* x", 0},
                                                {"x; y", 1},
                                                {"\"x\"", 0},
                                                {"x ** y", 3},
                                                {"m", 0},
                                                {"x[1]", 0},
                                                {"1 + m[3]", 4},
                                                {"m[1.5]", 3},
                                                {"m[x]", 2},
                                                {"m[1, 2]", 0},
                                                {"m[1 % 0]", 3},
                                                {"sum(j, 3)", 6},
                                                {"sum(j, 1, 2)", 4},
                                                {"sum(j, m[j]", 11},
                                                {"m[9999999999999]", 2},
                                                {"len(x)", 4}};
  for (const auto& [text, position] : bad) {
    const ExpressionFault fault = fault_of(text);
    EXPECT_EQ(fault.position, position) << text << ": " << fault.message;
    EXPECT_FALSE(fault.message.empty());
  }
}

TEST(Expression, FaultsNameTheNearestNameAndShowThePlace) {
  const std::string text = "x +\n 2 * vy";
  const ExpressionFault fault = fault_of(text);
  EXPECT_EQ(fault.did_you_mean, "y");
  EXPECT_EQ(fault_of("sine(x)").did_you_mean, "sin");
  const std::string shown = describe(fault, text);
  EXPECT_NE(shown.find("line 2, column 6"), std::string::npos) << shown;
  EXPECT_NE(shown.find(">>>vy"), std::string::npos) << shown;
}

TEST(Expression, SizeDepthAndWorkAreBounded) {
  for (const std::string& text :
       {std::string(4001, '1'), std::string(400, '(') + "1" + std::string(400, ')'),
        std::string(900, '-') + "1", std::string("sum(i, 1, 2000, sum(j, 1, 2000, i * j * x))"),
        std::string("sum(i, 0, 999999999, 0)"), std::string("sum(i, 1, 10000, sum(j, i, 10000, x ^ j))")}) {
    EXPECT_NE(fault_of(text).message, "") << text.substr(0, 40);
  }
}

TEST(Expression, FamiliesAndSumsAreTheirTermsWrittenOut) {
  CompiledExpressions e({"k"});
  e.array("x", 4);
  e.array("m", 4);
  const std::vector<double> values = {1.7, 0.3, -1.2, 2.5, 0.11, 1, 2, 3, 4};
  const std::pair<std::string, std::string> pairs[] = {
      {"sum(j != i, m[j] * (x[j] - x[i]))", "m[0]*(x[0]-x[2]) + m[1]*(x[1]-x[2]) + m[3]*(x[3]-x[2])"},
      {"sum(j, j == i ? 0 : m[j])", "m[0] + m[1] + m[3]"},
      {"sum(j > i, x[j])", "x[3]"},
      {"sum(j, 1, i, j * x[j - 1])", "1 * x[0] + 2 * x[1]"},
      {"sum(j, 3, 1, x[j])", "0"},
      {"x[(i + 3) % len(x)] - x[(i - 3) % 4]", "x[1] - x[3]"},
      {"i == 0 ? x[i - 1] : x[i + 1]", "x[3]"},
      {"i > 2 && x[i + 2] > 0 ? 1 : k", "k"},
      {"sum(a, sum(b != a, x[a] * m[b]))",
       "x[0]*m[1]+x[0]*m[2]+x[0]*m[3] + (x[1]*m[0]+x[1]*m[2]+x[1]*m[3]) + (x[2]*m[0]+x[2]*m[1]+x[2]*m[3]) + "
       "(x[3]*m[0]+x[3]*m[1]+x[3]*m[2])"}};
  for (const auto& [family, written] : pairs) {
    e.roots.clear();
    e.root(family, {{"i", 2}});
    e.root(written);
    const auto v = e.at(values);
    EXPECT_TRUE(same_bits(v[0], v[1])) << family << ": " << v[0] << " and " << v[1];
  }
}

TEST(Expression, DefinitionsSeeWhatCameBefore) {
  CompiledExpressions e({});
  e.array("x", 3);
  EXPECT_TRUE(e.names.add_definition("d", {"i", "j"}, "x[i] - x[j]"));
  EXPECT_TRUE(e.names.add_definition("r", {"i", "j"}, "d[i, j]^2"));
  EXPECT_FALSE(e.names.add_definition("x", {"i"}, "1"));
  EXPECT_FALSE(e.names.add_value("sin", 0));
  EXPECT_FALSE(e.names.add_value("2x", 0));
  EXPECT_TRUE(e.names.add_definition("loop", {"i"}, "loop[i]"));
  e.root("r[0, 2] + r[2, 0]");
  EXPECT_EQ(e.at({1, 0, 4})[0], 18);
  EXPECT_THROW(e.root("loop[0]"), ExpressionFault);
  EXPECT_THROW(e.root("r[0, 3]"), ExpressionFault);
}

TEST(Expression, EqualPartsAreComputedOnce) {
  CompiledExpressions e({"x", "y"});
  e.root("(x - y)^2 / 3");
  const size_t alone = e.graph.size();
  e.root("(y - x)^2 / 3");
  EXPECT_EQ(e.roots[0], e.roots[1]);
  // y - x itself is a node; everything above it is shared.
  EXPECT_EQ(e.graph.size(), alone + 1);
  e.root("x / 4");
  EXPECT_EQ(e.graph.at(e.roots[2]).op, Operator::multiply);
  e.root("x / 3");
  EXPECT_EQ(e.graph.at(e.roots[3]).op, Operator::divide);  // no product with 1/3 has the same bits
}

}  // namespace
}  // namespace truestep::test
