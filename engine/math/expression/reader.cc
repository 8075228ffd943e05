// Texts become nodes while they are read; the grammar is in names.h.
#include <charconv>
#include <cmath>

#include "engine/base/nearest_name.h"
#include "engine/math/expression/lexis.h"
#include "engine/math/expression/names.h"

namespace truestep {

using namespace lexis;
using Node = ExpressionGraph::Node;

/// Recursive descent over one text, one function per level of precedence.
class ExpressionReader {
 public:
  using Symbol = ExpressionNames::Symbol;

  /// `visible`: number of symbols that the text may name; `depth`: of the texts around it.
  ExpressionReader(const ExpressionNames& names, ExpressionGraph& graph, std::string_view text,
                   ExpressionNames::Bindings bindings, size_t visible, int depth)
      : names_(names),
        graph_(graph),
        text_(text),
        bindings_(std::move(bindings)),
        visible_(visible),
        depth_(depth) {}

  Node whole() {
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

 private:
  [[noreturn]] static void fail(size_t position, std::string message, std::string did_you_mean = "") {
    throw ExpressionFault{position, std::move(message), std::move(did_you_mean)};
  }
  static std::string printable(char c) { return c >= ' ' && c <= '~' ? std::string(1, c) : "?"; }
  void skip_spaces() {
    while (at_ < text_.size() && blank(text_[at_])) ++at_;
  }
  /// Takes the token when it comes next.
  bool take(std::string_view token) {
    skip_spaces();
    if (text_.substr(at_, token.size()) != token) return false;
    at_ += token.size();
    return true;
  }
  void expect(std::string_view token) {
    if (!take(token)) fail(at_, "expected \"" + std::string(token) + '"');
  }
  void deeper() {
    if (++depth_ > ExpressionNames::kMaxDepth) fail(at_, "nested too deeply");
  }

  Node choice() {
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
  Node either() {
    Node n = both();
    while (take("||")) n = graph_.binary(O::either, n, both());
    return n;
  }
  Node both() {
    Node n = compare();
    while (take("&&")) n = graph_.binary(O::both, n, compare());
    return n;
  }
  Node compare() {
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
  Node sum() {
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
  Node product() {
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
  Node sign() {
    deeper();
    const Node n = take("-") ? graph_.unary(O::negate, sign()) : take("+") ? sign() : power();
    --depth_;
    return n;
  }
  Node power() {
    const Node n = atom();
    return take("^") ? graph_.power(n, sign()) : n;
  }

  Node atom() {
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
  double number() {
    double value = 0;
    const auto [rest, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) fail(at_, "this is no finite number");
    at_ = static_cast<size_t>(rest - text_.data());
    return value;
  }

  std::string_view take_name() {
    skip_spaces();
    const size_t n = name_length(text_, at_);
    if (n == 0) fail(at_, "expected a name");
    const std::string_view id = text_.substr(at_, n);
    at_ += n;
    return id;
  }
  const int64_t* binding(std::string_view id) const {
    for (size_t k = bindings_.size(); k-- > 0;) {
      if (bindings_[k].first == id) return &bindings_[k].second;
    }
    return nullptr;
  }
  const Symbol* symbol(std::string_view id) const {
    const auto found = names_.by_name_.find(id);
    return found != names_.by_name_.end() && found->second < visible_ ? &names_.symbols_[found->second]
                                                                      : nullptr;
  }
  [[noreturn]] void unknown(size_t start, std::string_view id) const {
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

  Node name() {
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
  Node call(const ExpressionFunction& f) {
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
  Node element(const Symbol& s, size_t start) {
    if (!take("[")) fail(start, "\"" + s.name + "\" is an array: write " + s.name + "[i]");
    std::vector<int64_t> indices;
    do {
      indices.push_back(index());
    } while (take(","));
    expect("]");
    const size_t wanted = s.kind == Symbol::Kind::array ? 1 : s.indices.size();
    if (indices.size() != wanted) {
      fail(start,
           "\"" + s.name + "\" takes " + std::to_string(wanted) + (wanted == 1 ? " index" : " indices"));
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
  Node expand(const Symbol& s, const std::vector<int64_t>& indices, size_t start) {
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

  // --- indices: integers known while the text is read

  static constexpr int64_t kLargest = 1'000'000'000;
  int64_t bounded(int64_t v, size_t position) const {
    if (v > kLargest || v < -kLargest) fail(position, "the index is too large");
    return v;
  }
  int64_t index() {
    deeper();
    int64_t v = index_product();
    while (true) {
      const size_t start = at_;
      if (take("+")) {
        v = bounded(v + index_product(), start);
      } else if (take("-")) {
        v = bounded(v - index_product(), start);
      } else {
        --depth_;
        return v;
      }
    }
  }
  int64_t index_product() {
    int64_t v = index_atom();
    while (true) {
      const size_t start = at_;
      if (take("*")) {
        v = bounded(v * index_atom(), start);
      } else if (take("/") || take("%")) {
        const bool division = text_[at_ - 1] == '/';
        const int64_t d = index_atom();
        if (d <= 0) fail(start, "an index is divided by a number that is not positive");
        // Rounded down, so that (i - 1) % n runs round a ring.
        const int64_t rest = ((v % d) + d) % d;
        v = division ? (v - rest) / d : rest;
      } else {
        return v;
      }
    }
  }
  int64_t index_atom() {
    skip_spaces();
    graph_.charge(at_);
    const size_t start = at_;
    if (take("(")) {
      const int64_t v = index();
      expect(")");
      return v;
    }
    if (take("-")) {
      deeper();
      const int64_t v = -index_atom();
      --depth_;
      return v;
    }
    if (start < text_.size() && digit(text_[start])) {
      int64_t v = 0;
      while (at_ < text_.size() && digit(text_[at_])) v = bounded(10 * v + (text_[at_++] - '0'), start);
      return v;
    }
    const std::string_view id = take_name();
    if (const int64_t* v = binding(id)) return *v;
    if (id == "len") {
      expect("(");
      const size_t at = at_;
      const std::string_view array = take_name();
      const Symbol* s = symbol(array);
      if (!s) unknown(at, array);
      if (s->kind != Symbol::Kind::array) fail(at, "\"" + s->name + "\" is no array");
      expect(")");
      return static_cast<int64_t>(s->nodes.size());
    }
    if (symbol(id))
      fail(start, "an index is made of integers and index names; \"" + std::string(id) + "\" is neither");
    unknown(start, id);
  }

  // --- sums

  enum class Relation : uint8_t { none, not_equal, less_equal, greater_equal, less, greater };
  static bool holds(Relation r, int64_t a, int64_t b) {
    return r == Relation::none || (r == Relation::not_equal && a != b) ||
           (r == Relation::less_equal && a <= b) || (r == Relation::greater_equal && a >= b) ||
           (r == Relation::less && a < b) || (r == Relation::greater && a > b);
  }
  /// Commas between here and the parenthesis that ends the sum.
  int commas_ahead() const {
    int open = 0, commas = 0;
    for (size_t k = at_; k < text_.size(); ++k) {
      const char c = text_[k];
      if (c == '(' || c == '[') ++open;
      if ((c == ')' || c == ']') && --open < 0) break;
      commas += c == ',' && open == 0;
    }
    return commas;
  }
  /// Length of the arrays that stand with [index] between here and the end of the sum.
  int64_t range_of(const std::string& index) const {
    int open = 0;
    for (size_t k = at_; k < text_.size();) {
      if (const size_t n = name_length(text_, k)) {
        const Symbol* s = symbol(text_.substr(k, n));
        k += n;
        if (!s || s->kind != Symbol::Kind::array) continue;
        size_t p = k;
        const auto skip = [&] {
          while (p < text_.size() && blank(text_[p])) ++p;
        };
        skip();
        if (p == text_.size() || text_[p] != '[') continue;
        ++p;
        skip();
        if (text_.substr(p, index.size()) != index || name_length(text_, p) != index.size()) continue;
        p += index.size();
        skip();
        if (p < text_.size() && text_[p] == ']') return static_cast<int64_t>(s->nodes.size());
        continue;
      }
      const char c = text_[k++];
      if (c == '(') ++open;
      if (c == ')' && --open < 0) break;
    }
    fail(at_, "the range of " + index + " is unclear: write sum(" + index + ", first, last, ...)");
  }
  Node sum_over() {
    expect("(");
    const size_t start = at_;
    const std::string index(take_name());
    static constexpr std::pair<std::string_view, Relation> kRelations[] = {{"!=", Relation::not_equal},
                                                                           {"<=", Relation::less_equal},
                                                                           {">=", Relation::greater_equal},
                                                                           {"<", Relation::less},
                                                                           {">", Relation::greater}};
    Relation relation = Relation::none;
    int64_t bound = 0;
    for (const auto& [token, r] : kRelations) {
      if (!take(token)) continue;
      relation = r;
      bound = this->index();
      break;
    }
    expect(",");
    const int commas = commas_ahead();
    int64_t first = 0, last;
    if (commas == 0) {
      last = range_of(index) - 1;
    } else {
      if (commas != 2) fail(start, "sum takes (index, terms) or (index, first, last, terms)");
      first = this->index();
      expect(",");
      last = this->index();
      expect(",");
    }
    const size_t body = at_;
    Node total = ExpressionGraph::kNone;
    bindings_.emplace_back(index, first);
    bool read = false;
    for (int64_t k = first; k <= last; ++k) {
      graph_.charge(body);
      if (!holds(relation, k, bound)) continue;
      bindings_.back().second = k;
      at_ = body;
      const Node term = choice();
      read = true;
      if (graph_.constant_value(term) == 0.0) continue;
      total = total == ExpressionGraph::kNone ? term : graph_.binary(O::add, total, term);
    }
    if (!read) choice();
    bindings_.pop_back();
    expect(")");
    return total == ExpressionGraph::kNone ? graph_.constant(0) : total;
  }

  const ExpressionNames& names_;
  ExpressionGraph& graph_;
  std::string_view text_;
  ExpressionNames::Bindings bindings_;
  size_t visible_;
  size_t at_ = 0;
  int depth_;
};

Node ExpressionNames::read(ExpressionGraph& graph, std::string_view text, const Bindings& bindings) const {
  return ExpressionReader(*this, graph, text, bindings, symbols_.size(), 0).whole();
}

Node ExpressionNames::require(ExpressionGraph& graph, std::string_view text, const Bindings& bindings) const {
  const Node n = read(graph, text, bindings);
  if (const ExpressionFault* fault = graph.fault_of(n)) throw *fault;
  return n;
}

}  // namespace truestep
