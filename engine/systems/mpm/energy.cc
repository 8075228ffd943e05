#include "engine/systems/mpm/energy.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/math/expression/names.h"

namespace truestep::mpm {

namespace {

using Node = ExpressionGraph::Node;

/// Name of an operator that is not differentiable everywhere, or null.
const char* kink(Operator op) {
  switch (op) {
    case Operator::abs:
      return "abs";
    case Operator::sign:
      return "sign";
    case Operator::floor:
      return "floor";
    case Operator::min:
      return "min";
    case Operator::max:
      return "max";
    case Operator::choose:
      return "a condition";
    case Operator::less:
    case Operator::less_equal:
    case Operator::equal:
    case Operator::not_equal:
    case Operator::both:
    case Operator::either:
      return "a comparison";
    default:
      return nullptr;
  }
}

/// The first such operator among a node's inputs, or null.
const char* first_kink(const ExpressionGraph& graph, Node root) {
  std::vector<Node> left{root};
  std::vector<bool> seen(graph.size(), false);
  while (!left.empty()) {
    const Node n = left.back();
    left.pop_back();
    if (n == ExpressionGraph::kNone || seen[static_cast<size_t>(n)]) continue;
    seen[static_cast<size_t>(n)] = true;
    const auto& e = graph.at(n);
    if (const char* found = kink(e.op)) return found;
    if (arity(e.op) > 0) left.insert(left.end(), {e.a, e.b, e.c});
  }
  return nullptr;
}

}  // namespace

EnergyLaw::EnergyLaw(const std::string& text, int dimension, const Material& material,
                     const std::string& pointer)
    : dimension_(dimension) {
  const auto refuse = [&](const std::string& message, const std::string& meant = "") {
    throw Error("scene_invalid", message, {pointer, "bad_expression", message, text, "", meant, ""});
  };
  ExpressionGraph graph;
  ExpressionNames names;
  using O = Operator;
  const int32_t d = dimension;
  std::vector<Node> s;
  for (int32_t k = 0; k < d; ++k) {
    s.push_back(graph.variable(k));
    names.add_value(std::string{'s', static_cast<char>('1' + k)}, s.back());
  }
  Node i1 = graph.constant(0), i2 = graph.constant(0), j = graph.constant(1);
  std::vector<Node> squares;
  for (const Node n : s) {
    squares.push_back(graph.binary(O::multiply, n, n));
    for (size_t k = 0; k + 1 < squares.size(); ++k)
      i2 = graph.binary(O::add, i2, graph.binary(O::multiply, squares[k], squares.back()));
    i1 = graph.binary(O::add, i1, squares.back()), j = graph.binary(O::multiply, j, n);
  }
  names.add_value("I1", i1), names.add_value("I2", i2), names.add_value("J", j);
  names.add_value("mu", graph.constant(material.mu)),
      names.add_value("lambda", graph.constant(material.lambda));
  try {
    const Node energy = names.require(graph, text);
    if (const char* found = first_kink(graph, energy)) {
      refuse(std::string("an energy must have derivatives everywhere; this one has ") + found);
    }
    std::vector<Node> roots{energy};
    std::vector<ExpressionGraph::Partial> partials;
    const auto derivative = [&](Node of, int32_t by) {
      partials.clear();
      graph.differentiate(of, by, 1, partials);
      return partials.empty() ? graph.constant(0) : partials[0].node;
    };
    for (int32_t k = 0; k < d; ++k) roots.push_back(derivative(energy, k));
    for (int32_t k = 0; k < d; ++k) roots.push_back(derivative(roots[static_cast<size_t>(1 + k)], k));
    program_ = ExpressionRows(graph, roots);
  } catch (const ExpressionFault& f) {
    refuse(describe(f, text), f.did_you_mean);
  }
  const auto at = [&](double a, double b, double c) {
    std::array<double, 7> out{};
    run(&a, &b, &c, 1, out.data(), 1);
    return out;
  };
  const std::array<double, 7> rest = at(1, 1, 1);
  for (int k = 0; k < 1 + 2 * d; ++k) {
    if (!std::isfinite(rest[static_cast<size_t>(k)]))
      refuse("the energy or one of its derivatives is no number at rest");
  }
  const auto slope = [&](int k) { return rest[static_cast<size_t>(1 + k)]; };
  const auto bend = [&](int k) { return rest[static_cast<size_t>(1 + d + k)]; };
  for (int k = 0; k < d; ++k) {
    if (!(bend(k) > 0)) refuse("no stiffness at rest: the second derivative is not positive");
    // Rounding of constants that should cancel, no more.
    if (std::abs(slope(k)) > 1e-9 * bend(k))
      refuse("the energy must have its minimum at rest, but there is a stress there");
  }
  // Two exchanges generate all permutations; two points, in case one is special.
  const double places[2][3] = {{1.1, 0.85, 1.02}, {0.93, 1.21, 0.78}};
  for (const auto& p : places) {
    const double here = at(p[0], p[1], p[2])[0], scale = std::abs(here) + bend(0) * 1e-6;
    const auto same = [&](double other) { return std::abs(other - here) <= 1e-9 * scale; };
    if (!same(at(p[1], p[0], p[2])[0]) || (d == 3 && !same(at(p[0], p[2], p[1])[0])))
      refuse("the energy must be isotropic: it changes when singular values are swapped");
  }
}

void EnergyLaw::run(const double* s1, const double* s2, const double* s3, size_t count, double* out,
                    size_t stride) const {
  const ExpressionRows::Column variables[] = {{s1, 1}, {s2, 1}, {s3, 1}};
  ExpressionRows::Output to[7];
  const auto roots = static_cast<size_t>(1 + 2 * dimension_);
  for (size_t k = 0; k < roots; ++k) to[k] = {out + k * stride, 1};
  program_.run({variables, static_cast<size_t>(dimension_)}, {to, roots}, 0, count);
}

}  // namespace truestep::mpm
