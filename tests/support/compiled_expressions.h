// A list of texts compiled both ways, for one point and for many rows, over named variables in a fixed order.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "engine/math/expression/names.h"
#include "engine/math/expression/program.h"
#include "engine/math/expression/rows.h"

namespace truestep::test {

/// Equal bits; any NaN equals any other, since payloads are meaningless.
inline bool same_bits(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || std::bit_cast<uint64_t>(a) == std::bit_cast<uint64_t>(b);
}

struct CompiledExpressions {
  ExpressionGraph graph;
  ExpressionNames names;
  std::vector<ExpressionGraph::Node> roots;
  size_t variables = 0;

  explicit CompiledExpressions(const std::vector<std::string>& variable_names) {
    for (const std::string& v : variable_names) {
      names.add_value(v, graph.variable(static_cast<int32_t>(variables++)));
    }
  }
  void array(const std::string& name, size_t n) {
    std::vector<ExpressionGraph::Node> nodes;
    for (size_t i = 0; i < n; ++i) nodes.push_back(graph.variable(static_cast<int32_t>(variables++)));
    names.add_array(name, std::move(nodes));
  }
  void root(const std::string& text, const ExpressionNames::Bindings& bindings = {}) {
    roots.push_back(names.require(graph, text, bindings));
  }
  ExpressionProgram program() const { return {graph, roots, variables}; }

  std::vector<double> at(const std::vector<double>& values) const {
    const ExpressionProgram p = program();
    std::vector<double> registers(p.registers()), out(roots.size());
    p.start(registers.data());
    std::copy(values.begin(), values.end(), registers.begin());
    p.run(registers.data(), out.data());
    return out;
  }
  /// Row after row of `variables` values in, row after row of roots out.
  std::vector<double> rows(const std::vector<double>& values) const {
    const ExpressionRows r(graph, roots);
    const size_t n = values.size() / variables;
    std::vector<double> out(n * roots.size());
    std::vector<ExpressionRows::Column> in;
    std::vector<ExpressionRows::Output> to;
    for (size_t k = 0; k < variables; ++k) in.push_back({values.data() + k, variables});
    for (size_t k = 0; k < roots.size(); ++k) to.push_back({out.data() + k, roots.size()});
    r.run(in, to, 0, n);
    return out;
  }
};

}  // namespace truestep::test
