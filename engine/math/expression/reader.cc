#include "engine/math/expression/reader.h"

namespace truestep {

using namespace lexis;
using Node = ExpressionGraph::Node;

ExpressionReader::Node ExpressionReader::whole() {
  if (text_.size() > ExpressionNames::kMaxLength) {
    fail(ExpressionNames::kMaxLength,
         "longer than " + std::to_string(ExpressionNames::kMaxLength) + " characters");
  }
  const Node n = choice();
  skip_spaces();
  if (at_ < text_.size()) {
    fail(at_, text_[at_] == '=' ? "assignment is not possible; compare with =="
                                : "unexpected \"" + printable(text_[at_]) + '"');
  }
  return n;
}

ExpressionReader::Node ExpressionReader::choice() {
  deeper();
  Node n = either();
  if (take("?")) {
    const Node a = choice();
    expect(":");
    const Node b = choice();
    n = graph_.choose(n, a, b);
  }
  --depth_;
  return n;
}

ExpressionReader::Node ExpressionReader::either() {
  Node n = both();
  while (take("||")) n = graph_.binary(O::either, n, both());
  return n;
}

ExpressionReader::Node ExpressionReader::both() {
  Node n = compare();
  while (take("&&")) n = graph_.binary(O::both, n, compare());
  return n;
}

ExpressionReader::Node ExpressionReader::compare() {
  const Node a = sum();
  static constexpr std::pair<std::string_view, O> kOps[] = {{"<=", O::less_equal}, {">=", O::less_equal},
                                                            {"==", O::equal},      {"!=", O::not_equal},
                                                            {"<", O::less},        {">", O::less}};
  for (const auto& [token, op] : kOps) {
    if (!take(token)) continue;
    const Node b = sum();
    return token[0] == '>' ? graph_.binary(op, b, a) : graph_.binary(op, a, b);
  }
  return a;
}

ExpressionReader::Node ExpressionReader::sum() {
  Node n = product();
  while (true) {
    if (take("+")) {
      n = graph_.binary(O::add, n, product());
    } else if (take("-")) {
      n = graph_.binary(O::subtract, n, product());
    } else {
      return n;
    }
  }
}

ExpressionReader::Node ExpressionReader::product() {
  Node n = sign();
  while (true) {
    if (take("*")) {
      n = graph_.binary(O::multiply, n, sign());
    } else if (take("/")) {
      n = graph_.binary(O::divide, n, sign());
    } else {
      return n;
    }
  }
}

ExpressionReader::Node ExpressionReader::sign() {
  deeper();
  const Node n = take("-") ? graph_.unary(O::negate, sign()) : take("+") ? sign() : power();
  --depth_;
  return n;
}

ExpressionReader::Node ExpressionReader::power() {
  const Node n = atom();
  return take("^") ? graph_.power(n, sign()) : n;
}

Node ExpressionNames::read(ExpressionGraph& graph, std::string_view text, const Bindings& bindings) const {
  return ExpressionReader(*this, graph, text, bindings, symbols_.size(), 0).whole();
}

Node ExpressionNames::require(ExpressionGraph& graph, std::string_view text, const Bindings& bindings) const {
  const Node n = read(graph, text, bindings);
  if (const ExpressionFault* fault = graph.fault_of(n)) throw *fault;
  return n;
}

}  // namespace truestep
