// Converts texts to nodes while reading them; the grammar is in names.h. Implemented in reader*.cc: levels of
// precedence, names and values, indices, sums.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/math/expression/lexis.h"
#include "engine/math/expression/names.h"

namespace truestep {

/// Recursive descent over one text, one function per level of precedence.
class ExpressionReader {
 public:
  using Node = ExpressionGraph::Node;
  using Symbol = ExpressionNames::Symbol;

  /// `visible`: number of symbols that the text may name; `depth`: of the enclosing texts.
  ExpressionReader(const ExpressionNames& names, ExpressionGraph& graph, std::string_view text,
                   ExpressionNames::Bindings bindings, size_t visible, int depth)
      : names_(names),
        graph_(graph),
        text_(text),
        bindings_(std::move(bindings)),
        visible_(visible),
        depth_(depth) {}

  /// The node of the whole text. Throws ExpressionFault.
  Node whole();

 private:
  [[noreturn]] static void fail(size_t position, std::string message, std::string did_you_mean = "") {
    throw ExpressionFault{position, std::move(message), std::move(did_you_mean)};
  }
  static std::string printable(char c) { return c >= ' ' && c <= '~' ? std::string(1, c) : "?"; }
  void skip_spaces() {
    while (at_ < text_.size() && lexis::blank(text_[at_])) ++at_;
  }
  /// Consumes the token if it comes next.
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

  Node choice();
  Node either();
  Node both();
  Node compare();
  Node sum();
  Node product();
  Node sign();
  Node power();

  Node atom();
  double number();
  std::string_view take_name();
  const int64_t* binding(std::string_view id) const;
  const Symbol* symbol(std::string_view id) const;
  [[noreturn]] void unknown(size_t start, std::string_view id) const;
  Node name();
  Node call(const lexis::ExpressionFunction& f);
  Node element(const Symbol& s, size_t start);
  Node expand(const Symbol& s, const std::vector<int64_t>& indices, size_t start);

  /// Indices are integers, known while the text is read.
  int64_t index();
  int64_t index_product();
  int64_t index_atom();

  /// Commas between here and the closing parenthesis of the sum.
  int commas_ahead() const;
  /// Length of the arrays indexed with [index] between here and the end of the sum.
  int64_t range_of(const std::string& index) const;
  Node sum_over();

  const ExpressionNames& names_;
  ExpressionGraph& graph_;
  std::string_view text_;
  ExpressionNames::Bindings bindings_;
  size_t visible_;
  size_t at_ = 0;
  int depth_;
};

}  // namespace truestep
