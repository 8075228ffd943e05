#include "engine/systems/mpm/texts.h"

#include "engine/base/errors.h"
#include "engine/math/expression/names.h"

namespace truestep::mpm {

Texts::Texts(const std::vector<std::string>& texts, int dimension, const std::string& pointer) {
  ExpressionGraph graph;
  ExpressionNames names;
  const char* const variables[] = {"t", "x", "y", "z"};
  for (int32_t v = 0; v <= dimension; ++v) names.add_value(variables[v], graph.variable(v));
  std::vector<Issue> issues;
  for (size_t c = 0; c < texts.size(); ++c) {
    try {
      const ExpressionGraph::Node n = names.require(graph, texts[c]);
      programs_.emplace_back(graph, std::span<const ExpressionGraph::Node>(&n, 1));
    } catch (const ExpressionFault& f) {
      issues.push_back({pointer + "/" + std::to_string(c), "bad_expression", describe(f, texts[c]), texts[c],
                        "", f.did_you_mean, ""});
    }
  }
  if (!issues.empty()) throw Error("scene_invalid", issues[0].message, issues);
}

void Texts::run(size_t c, double t, const double* x, const double* y, const double* z, size_t count,
                double* out) const {
  const ExpressionRows::Column variables[] = {{&t, 0}, {x, 1}, {y, 1}, {z, 1}};
  const ExpressionRows::Output to{out, 1};
  programs_[c].run(variables, {&to, 1}, 0, count);
}

}  // namespace truestep::mpm
