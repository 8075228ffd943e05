#include "engine/systems/heightfield_wave/basin_texts.h"

#include "engine/base/errors.h"
#include "engine/math/expression/names.h"

namespace truestep::heightfield_wave {

namespace {
using Node = ExpressionGraph::Node;
enum Variable : int32_t { kTimeAxis, kXAxis, kYAxis };
}  // namespace

BasinTexts::BasinTexts(const HeightfieldWaveDef& d) : has_exact(!d.exact.empty()) {
  ExpressionGraph graph;
  ExpressionNames still, moving;
  const char* const names[] = {"t", "x", "y"};
  for (int32_t v = 0; v < static_cast<int32_t>(1 + d.cells.size()); ++v) {
    const Node n = graph.variable(v);
    moving.add_value(names[v], n);
    if (v > 0) still.add_value(names[v], n);
  }
  std::vector<Issue> issues;
  const auto read = [&](ExpressionNames& known, const std::string& pointer, const std::string& text) {
    try {
      const Node n = known.require(graph, text);
      return ExpressionRows(graph, {&n, 1});
    } catch (const ExpressionFault& f) {
      issues.push_back({pointer, "bad_expression", describe(f, text), text, "", f.did_you_mean, ""});
      return ExpressionRows();
    }
  };
  bed = read(still, "/bed", d.bed);
  surface = read(still, "/surface", d.surface);
  if (has_exact) exact = read(moving, "/exact", d.exact);
  for (size_t a = 0; a < d.cells.size(); ++a) {
    velocity[a] = d.velocity.empty() ? read(still, "/velocity", "0")
                                     : read(still, "/velocity/" + std::to_string(a), d.velocity[a]);
  }
  if (!issues.empty()) throw Error("scene_invalid", issues[0].message, issues);
}

void BasinTexts::sample(const ExpressionRows& text, const shallow::Basin& b, double t, double* out) {
  std::vector<double> x(b.cells[0]);
  for (size_t i = 0; i < x.size(); ++i) x[i] = b.centre(0, i);
  for (size_t j = 0; j < b.cells[1]; ++j) {
    const double y = b.centre(1, j);
    const ExpressionRows::Column in[] = {{&t, 0}, {x.data(), 1}, {&y, 0}};
    const ExpressionRows::Output to[] = {{out + x.size() * j, 1}};
    text.run(in, to, 0, x.size());
  }
}

}  // namespace truestep::heightfield_wave
