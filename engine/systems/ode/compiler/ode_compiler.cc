// The order in which a scene's texts are processed, and shared helpers: faults, reading, elements of arrays.
#include "engine/systems/ode/compiler/ode_compiler.h"

#include <algorithm>
#include <charconv>

namespace truestep::ode {

OdeModel OdeCompiler::compile() {
  declare();
  definitions();
  equations();
  rest();
  tracers();
  if (!issues_.empty()) {
    const std::string first = issues_[0].pointer + ": " + issues_[0].message;
    throw Error("scene_invalid", first, std::move(issues_));
  }
  programs();
  return std::move(model_);
}

void OdeCompiler::fault(const std::string& pointer, const ExpressionFault& f, std::string_view text) {
  issue(pointer, "bad_expression", describe(f, text), text, "", f.did_you_mean);
}

void OdeCompiler::issue(const std::string& pointer, const char* code, const std::string& message,
                        std::string_view value, const std::string& allowed, const std::string& did_you_mean) {
  if (issues_.size() >= 100) return;
  std::string shown;
  for (const char c : value.substr(0, 80)) shown += c >= ' ' && c <= '~' && c != '"' && c != '\\' ? c : '?';
  issues_.push_back(
      {pointer, code, message, value.empty() ? "" : '"' + shown + '"', allowed, did_you_mean, ""});
}

OdeCompiler::Node OdeCompiler::read(const std::string& pointer, const std::string& text,
                                    const ExpressionNames::Bindings& bindings) {
  try {
    return names_.require(graph_, text, bindings);
  } catch (const ExpressionFault& f) {
    fault(pointer, f, text);
    return graph_.constant(0);
  }
}

const OdeModel::Named* OdeCompiler::named(const std::vector<OdeModel::Named>& list,
                                          std::string_view name) const {
  for (const OdeModel::Named& n : list) {
    if (n.name == name) return &n;
  }
  return nullptr;
}

void OdeCompiler::each_element(const std::string& pointer, const std::string& left, const OdeModel::Named& n,
                               const ExpressionTarget& target, const EachUse& use) {
  const bool array = n.form == NamedNumbers::Form::array;
  if (target.indices.size() != (array ? 1u : 0u)) {
    return issue(pointer, "bad_target",
                 array ? "\"" + n.name + "\" is an array: write " + n.name + "[i]"
                       : "\"" + n.name + "\" is a single number and takes no index",
                 left);
  }
  if (!array) return use(n.places[0], ExpressionNames::Bindings{});
  const std::string& i = target.indices[0];
  if (i[0] < '0' || i[0] > '9') {
    if (!good_expression_name(i)) return issue(pointer, "bad_target", "not a valid name for an index", i);
    for (size_t k = 0; k < n.places.size(); ++k) {
      use(n.places[k], ExpressionNames::Bindings{{i, static_cast<int64_t>(k)}});
    }
    return;
  }
  size_t k = 0;
  std::from_chars(i.data(), i.data() + i.size(), k);
  if (k >= n.places.size()) {
    return issue(pointer, "bad_target", "indices run from 0 to " + std::to_string(n.places.size() - 1), left);
  }
  use(n.places[k], ExpressionNames::Bindings{});
}

}  // namespace truestep::ode
