// Atoms of an expression: numbers, names, functions, elements of arrays and of definitions.
#include <charconv>
#include <cmath>

#include "engine/base/text/nearest_name.h"
#include "engine/math/expression/reader.h"

namespace truestep {

using namespace lexis;

ExpressionReader::Node ExpressionReader::atom() {
  skip_spaces();
  graph_.charge(at_);
  if (at_ == text_.size()) fail(at_, "ends where a value is expected");
  const char c = text_[at_];
  if (take("(")) {
    const Node n = choice();
    expect(")");
    return n;
  }
  if (digit(c) || c == '.') return graph_.constant(number());
  if (letter(c)) return name();
  fail(at_, "expected a value, not \"" + printable(c) + '"');
}

double ExpressionReader::number() {
  double value = 0;
  const auto [rest, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
  if (error != std::errc{} || !std::isfinite(value)) fail(at_, "this is not a finite number");
  at_ = static_cast<size_t>(rest - text_.data());
  return value;
}

std::string_view ExpressionReader::take_name() {
  skip_spaces();
  const size_t n = name_length(text_, at_);
  if (n == 0) fail(at_, "expected a name");
  const std::string_view id = text_.substr(at_, n);
  at_ += n;
  return id;
}

const int64_t* ExpressionReader::binding(std::string_view id) const {
  for (size_t k = bindings_.size(); k-- > 0;) {
    if (bindings_[k].first == id) return &bindings_[k].second;
  }
  return nullptr;
}

const ExpressionReader::Symbol* ExpressionReader::symbol(std::string_view id) const {
  const auto found = names_.by_name_.find(id);
  return found != names_.by_name_.end() && found->second < visible_ ? &names_.symbols_[found->second]
                                                                    : nullptr;
}

void ExpressionReader::unknown(size_t start, std::string_view id) const {
  std::vector<std::string> known;
  for (const auto& [name, value] : bindings_) known.push_back(name);
  for (size_t k = 0; k < visible_; ++k) known.push_back(names_.symbols_[k].name);
  std::string list;
  for (const std::string& k : known) {
    if (list.size() < 200) list += (list.empty() ? "" : ", ") + k;
  }
  for (const ExpressionFunction& f : kExpressionFunctions) known.emplace_back(f.name);
  known.insert(known.end(), {"pi", "sum", "len"});
  fail(start, "unknown name \"" + std::string(id.substr(0, 64)) + "\"; known are " + list,
       nearest_name(id, known));
}

ExpressionReader::Node ExpressionReader::name() {
  const size_t start = at_;
  const std::string_view id = take_name();
  if (const int64_t* index = binding(id)) return graph_.constant(static_cast<double>(*index));
  if (const Symbol* s = symbol(id)) {
    if (s->kind == Symbol::Kind::value) {
      if (take("[")) fail(start, "\"" + s->name + "\" is one number and takes no index");
      return s->nodes[0];
    }
    return element(*s, start);
  }
  if (const ExpressionFunction* f = find_function(id)) return call(*f);
  if (id == "pi") return graph_.constant(3.141592653589793);
  if (id == "sum") return sum_over();
  if (id == "len") {
    at_ = start;
    return graph_.constant(static_cast<double>(index_atom()));
  }
  unknown(start, id);
}

ExpressionReader::Node ExpressionReader::call(const ExpressionFunction& f) {
  expect("(");
  const Node a = choice();
  Node b = ExpressionGraph::kNone;
  if (f.arguments == 2) {
    if (!take(",")) fail(at_, std::string(f.name) + " takes two arguments");
    b = choice();
  }
  expect(")");
  return f.arguments == 1 ? graph_.unary(f.op, a) : graph_.binary(f.op, a, b);
}

ExpressionReader::Node ExpressionReader::element(const Symbol& s, size_t start) {
  if (!take("[")) fail(start, "\"" + s.name + "\" is an array: write " + s.name + "[i]");
  std::vector<int64_t> indices;
  do {
    indices.push_back(index());
  } while (take(","));
  expect("]");
  const size_t wanted = s.kind == Symbol::Kind::array ? 1 : s.indices.size();
  if (indices.size() != wanted) {
    fail(start, "\"" + s.name + "\" takes " + std::to_string(wanted) + (wanted == 1 ? " index" : " indices"));
  }
  if (s.kind == Symbol::Kind::definition) return expand(s, indices, start);
  const auto n = static_cast<int64_t>(s.nodes.size());
  if (indices[0] < 0 || indices[0] >= n) {
    return graph_.fault({start,
                         s.name + "[" + std::to_string(indices[0]) +
                             "] does not exist: indices run from 0 to " + std::to_string(n - 1),
                         ""});
  }
  return s.nodes[static_cast<size_t>(indices[0])];
}

ExpressionReader::Node ExpressionReader::expand(const Symbol& s, const std::vector<int64_t>& indices,
                                                size_t start) {
  if (const auto found = s.known.find(indices); found != s.known.end()) return found->second;
  deeper();
  ExpressionNames::Bindings inner;
  for (size_t k = 0; k < indices.size(); ++k) inner.emplace_back(s.indices[k], indices[k]);
  const auto number = static_cast<size_t>(&s - names_.symbols_.data());
  Node n;
  try {
    n = ExpressionReader(names_, graph_, s.text, std::move(inner), number, depth_).whole();
  } catch (const ExpressionFault& fault) {
    fail(start, "in \"" + s.name + "\": " + fault.message, fault.did_you_mean);
  }
  --depth_;
  s.known.emplace(indices, n);
  return n;
}

}  // namespace truestep
