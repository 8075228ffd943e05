#include "engine/math/expression/place_texts.h"

#include "engine/base/errors.h"
#include "engine/math/expression/names.h"

namespace truestep {

PlaceTexts::PlaceTexts(const std::vector<std::string>& texts, int dimension, const std::string& pointer) {
  ExpressionGraph graph;
  ExpressionNames names;
  const char* const variables[] = {"t", "x", "y", "z"};
  for (int32_t v = 0; v <= dimension; ++v) names.add_value(variables[v], graph.variable(v));
  std::vector<Issue> issues;
  std::vector<ExpressionGraph::Node> roots;
  for (size_t c = 0; c < texts.size(); ++c) {
    try {
      roots.push_back(names.require(graph, texts[c]));
      if (roots.size() == texts.size()) program_ = ExpressionRows(graph, roots);
    } catch (const ExpressionFault& f) {
      issues.push_back({pointer + "/" + std::to_string(c), "bad_expression", describe(f, texts[c]), texts[c],
                        "", f.did_you_mean, ""});
    }
  }
  if (!issues.empty()) throw Error("scene_invalid", issues[0].message, issues);
  components_ = roots.size();
}

void PlaceTexts::run(double t, const double* x, const double* y, const double* z, size_t count, double* out,
                     size_t stride) const {
  const ExpressionRows::Column variables[] = {{&t, 0}, {x, 1}, {y, 1}, {z, 1}};
  const ExpressionRows::Output to[3] = {{out, 1}, {out + stride, 1}, {out + 2 * stride, 1}};
  program_.run(variables, {to, components_}, 0, count);
}

}  // namespace truestep
