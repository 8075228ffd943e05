// What the axes of a plot show. An axis that is a function of a single name, the same for all points, is
// labelled with that name's values: evenly spaced ones by slope and offset, others by the positions of powers
// of ten. Any other axis shows its own coordinate.
#include <algorithm>
#include <cmath>

#include "engine/systems/ode/compiler/ode_compiler.h"

namespace truestep::ode {

namespace {

constexpr int kFirstDecade = -20, kLastDecade = 20;

std::string one_line(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool blank = c == ' ' || c == '\n' || c == '\t';
    if (!blank) out += c;
    if (blank && !out.empty() && out.back() != ' ') out += ' ';
  }
  return out;
}

}  // namespace

std::string OdeCompiler::name_of(int32_t variable, Index index) const {
  if (variable == 0) return "t";
  const auto place = static_cast<uint32_t>(variable - first_state_);
  for (const OdeModel::Named& n : model_.states) {
    const auto at = std::find(n.places.begin(), n.places.end(), place);
    if (at == n.places.end()) continue;
    const bool numbered = index == Index::with && n.form == NamedNumbers::Form::array;
    return numbered ? n.name + "[" + std::to_string(at - n.places.begin()) + "]" : n.name;
  }
  return "";
}

std::vector<OdeCompiler::Node> OdeCompiler::along(size_t k) const {
  std::vector<Node> out;
  for (size_t body = 0; body < model_.bodies; ++body) out.push_back(plot_[3 * body + k]);
  return out;
}

PlotAxis OdeCompiler::axis(size_t k, const std::string& text) const {
  PlotAxis out;
  out.name = one_line(text);
  const std::vector<Node> roots = along(k);
  std::string name;
  for (const int32_t variable : graph_.variables_of(roots)) {
    if (is_parameter(variable)) continue;
    const std::string one = name_of(variable, Index::without);
    if (!name.empty() && one != name) return out;
    name = one;
  }
  if (name.empty()) return out;
  const ExpressionProgram program(graph_, roots, model_.variables());
  std::vector<double> registers(program.registers()), places(program.outputs());
  program.start(registers.data());
  const auto place = [&](double value) {
    std::fill_n(registers.begin(), model_.variables(), value);
    std::copy(model_.parameter_values.begin(), model_.parameter_values.end(), registers.begin() + 1);
    program.run(registers.data(), places.data());
    const bool same = std::all_of(places.begin(), places.end(), [&](double p) { return p == places[0]; });
    return same ? places[0] : std::nan("");
  };
  const double zero = place(0), slope = place(1) - zero;
  const double bend = place(2.5) - zero - 2.5 * slope;
  if (slope != 0 && std::abs(bend) < 1e-9 * (std::abs(zero) + std::abs(slope))) {
    out.slope = slope, out.offset = zero;
  } else {
    for (int e = kFirstDecade; e <= kLastDecade; ++e) {
      const double value = std::pow(10.0, e), at = place(value);
      if (!std::isfinite(at)) continue;
      if (!out.decades.empty() && at < out.decades.back()[1]) return out.decades.clear(), out;
      out.decades.push_back({value, at});
    }
    if (out.decades.size() < 2) return out.decades.clear(), out;
  }
  out.name = name;
  if (name == "t") out.unit = "s";
  return out;
}

std::vector<std::string> OdeCompiler::curves() const {
  std::vector<std::string> out;
  for (size_t body = 0; body < model_.bodies && model_.bodies > 1; ++body) {
    const std::vector<Node> own(plot_.begin() + static_cast<std::ptrdiff_t>(3 * body),
                                plot_.begin() + static_cast<std::ptrdiff_t>(3 * body + 3));
    std::string name;
    for (const int32_t variable : graph_.variables_of(own)) {
      if (variable < first_state_) continue;
      if (!name.empty()) return {};
      name = name_of(variable, Index::with);
    }
    if (name.empty()) return {};
    out.push_back(name);
  }
  return out;
}

}  // namespace truestep::ode
