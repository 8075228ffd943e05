// The names that a text may use, and the conversion of texts into nodes of a graph:
//   choice := either ("?" choice ":" choice)?
//   either := both ("||" both)*          both := compare ("&&" compare)*
//   compare := sum (("<"|"<="|">"|">="|"=="|"!=") sum)?
//   sum := product (("+"|"-") product)*  product := sign (("*"|"/") sign)*
//   sign := ("-"|"+") sign | power       power := atom ("^" sign)?
//   atom := number | name | name "[" index ("," index)* "]" | "(" choice ")"
//        | function "(" choice ("," choice)* ")" | "sum(" name (relation index)? "," (index "," index ",")?
//        choice ")"
//   index := integers, index names, len(array), + - * / %
// A name consists of letters, digits and _ and may end in primes (x'). `sum(j != i, f[j])` adds over the
// range of the arrays indexed with [j]; terms that are the constant 0 are left out. There are no other loops.
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/math/expression/graph.h"

namespace truestep {

class ExpressionNames {
 public:
  using Node = ExpressionGraph::Node;
  static constexpr size_t kMaxLength = 4000;
  static constexpr int kMaxDepth = 64;

  /// Later names never hide earlier ones: `add_*` returns false when the name is taken, reserved or
  /// ill-formed.
  bool add_value(std::string name, Node value);
  bool add_array(std::string name, std::vector<Node> elements);
  /// name[i, j ...] stands for the text, read anew for every index; it sees only names added before it.
  bool add_definition(std::string name, std::vector<std::string> indices, std::string text);

  /// Values of index names while a text is being read.
  using Bindings = std::vector<std::pair<std::string, int64_t>>;
  /// Throws ExpressionFault. The node may be a fault node: see `require`.
  Node read(ExpressionGraph& graph, std::string_view text, const Bindings& bindings = {}) const;
  /// The same, but throws for a value that does not exist.
  Node require(ExpressionGraph& graph, std::string_view text, const Bindings& bindings = {}) const;

 private:
  friend class ExpressionReader;
  struct Symbol {
    enum class Kind : uint8_t { value, array, definition } kind;
    std::string name;
    std::vector<Node> nodes;
    std::vector<std::string> indices;
    std::string text;
    mutable std::map<std::vector<int64_t>, Node> known;
  };
  bool add(Symbol symbol);
  std::vector<Symbol> symbols_;
  std::map<std::string, size_t, std::less<>> by_name_;
};

/// A left-hand side or a defined name: "x", "x[i]", "k[i, j]" or "x[3]".
struct ExpressionTarget {
  std::string name;
  std::vector<std::string> indices;  ///< names or integers
};
/// Throws ExpressionFault.
ExpressionTarget parse_expression_target(std::string_view text);

/// Whether a text is a name that expressions can use: not reserved (functions, pi, t may be used by callers).
bool good_expression_name(std::string_view name);

/// The fault in readable form: message, line and column (from 1), and the surrounding text with >>> at the
/// position.
std::string describe(const ExpressionFault& fault, std::string_view text);

}  // namespace truestep
