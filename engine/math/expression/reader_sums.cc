// sum(j, ...): the text of the terms is read again for every index.
#include <utility>

#include "engine/math/expression/reader.h"

namespace truestep {

using namespace lexis;

namespace {

enum class Relation : uint8_t { none, not_equal, less_equal, greater_equal, less, greater };

bool holds(Relation r, int64_t a, int64_t b) {
  return r == Relation::none || (r == Relation::not_equal && a != b) ||
         (r == Relation::less_equal && a <= b) || (r == Relation::greater_equal && a >= b) ||
         (r == Relation::less && a < b) || (r == Relation::greater && a > b);
}

}  // namespace

int ExpressionReader::commas_ahead() const {
  int open = 0, commas = 0;
  for (size_t k = at_; k < text_.size(); ++k) {
    const char c = text_[k];
    if (c == '(' || c == '[') ++open;
    if ((c == ')' || c == ']') && --open < 0) break;
    commas += c == ',' && open == 0;
  }
  return commas;
}

int64_t ExpressionReader::range_of(const std::string& index) const {
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

ExpressionReader::Node ExpressionReader::sum_over() {
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

}  // namespace truestep
