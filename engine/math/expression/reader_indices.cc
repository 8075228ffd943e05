// Indices in an expression: integers made of numbers, index names and lengths, known while the text is read.
#include "engine/math/expression/reader.h"

namespace truestep {

using namespace lexis;

namespace {

constexpr int64_t kLargest = 1'000'000'000;

int64_t bounded(int64_t v, size_t position) {
  if (v > kLargest || v < -kLargest) throw ExpressionFault{position, "the index is too large", ""};
  return v;
}

}  // namespace

int64_t ExpressionReader::index() {
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

int64_t ExpressionReader::index_product() {
  int64_t v = index_atom();
  while (true) {
    const size_t start = at_;
    if (take("*")) {
      v = bounded(v * index_atom(), start);
    } else if (take("/") || take("%")) {
      const bool division = text_[at_ - 1] == '/';
      const int64_t d = index_atom();
      if (d <= 0) fail(start, "an index is divided by a number that is not positive");
      // Rounded down, so that (i - 1) % n wraps around a ring.
      const int64_t rest = ((v % d) + d) % d;
      v = division ? (v - rest) / d : rest;
    } else {
      return v;
    }
  }
}

int64_t ExpressionReader::index_atom() {
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
    if (s->kind != Symbol::Kind::array) fail(at, "\"" + s->name + "\" is not an array");
    expect(")");
    return static_cast<int64_t>(s->nodes.size());
  }
  if (symbol(id))
    fail(start, "an index is made of integers and index names; \"" + std::string(id) + "\" is neither");
  unknown(start, id);
}

}  // namespace truestep
