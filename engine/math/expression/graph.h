// Expressions as one directed acyclic graph in which equal subexpressions are the same node, shared by all
// components of a right-hand side. Building a node folds constants and replaces operations by cheaper ones,
// but only if the result has the same bits: x^n by products, x^(n/2) by a square root, division by a power of
// two by a product, (b - a)^2 by (a - b)^2, a + -b by a - b. A sign of zero or a NaN is never simplified
// away.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/math/expression/operator.h"

namespace truestep {

/// Why a text is not an expression, and the character (from 0) where it fails.
struct ExpressionFault {
  size_t position = 0;
  std::string message;
  std::string did_you_mean;  ///< nearest name, empty when none is near
};

class ExpressionGraph {
 public:
  using Node = int32_t;
  static constexpr Node kNone = -1;
  /// Bounds on what texts may expand to; reaching one is an ExpressionFault.
  static constexpr size_t kMaxNodes = 400'000, kMaxWork = 1'500'000;

  struct Entry {
    Operator op;
    Node a = kNone, b = kNone, c = kNone;  ///< operands; of a variable, `a` is its number
    double value = 0;                      ///< of a constant
  };

  Node constant(double value);
  Node variable(int32_t number);
  /// A value that does not exist, for the given reason; it propagates through every operation except a
  /// choice.
  Node fault(ExpressionFault why);
  Node unary(Operator op, Node a);
  Node binary(Operator op, Node a, Node b);
  Node choose(Node condition, Node a, Node b);
  /// a^b; see the head of this file.
  Node power(Node a, Node b);

  const Entry& at(Node n) const { return entries_[static_cast<size_t>(n)]; }
  size_t size() const { return entries_.size(); }
  std::optional<double> constant_value(Node n) const;
  /// The reason of a fault node, or null.
  const ExpressionFault* fault_of(Node n) const;

  /// Counts a parser's work against kMaxWork.
  void charge(size_t position);

  /// Partial derivatives of `root` by the variables [first, first + count): appends (variable - first, node)
  /// in ascending order, structural zeros left out. Reverse accumulation: cost about that of the root itself.
  struct Partial {
    int32_t variable;
    Node node;
  };
  void differentiate(Node root, int32_t first, int32_t count, std::vector<Partial>& out);
  /// Indices of all variables that the roots depend on, ascending.
  std::vector<int32_t> variables_of(std::span<const Node> roots) const;

 private:
  Node intern(Entry e);
  Node integer_power(Node a, int n);
  void rehash();
  void add_partials(Node n, Node adjoint);
  void accumulate(Node n, Node term);

  std::vector<Entry> entries_;
  std::vector<Node> table_;  ///< open addressing, size a power of two
  std::vector<ExpressionFault> faults_;
  size_t work_ = 0;
  std::vector<Node> adjoints_, touched_, cone_,
      stack_;  ///< of `differentiate`, all empty values between calls
  std::vector<uint8_t> in_cone_;
};

}  // namespace truestep
