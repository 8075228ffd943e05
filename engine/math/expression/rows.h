// A vector of expressions evaluated over many rows (particles, tracers): register code whose registers hold a
// block of rows each, so that one dispatched instruction does a block's work in SIMD lanes and a block's
// registers stay in the first-level cache. Registers are reused as soon as their last reader has run.
// Immutable, with no memory of its own beyond the stack, so any thread may run it.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/math/expression/graph.h"

namespace truestep {

class ExpressionRows {
 public:
  using Node = ExpressionGraph::Node;
  static constexpr size_t kBlock = 64, kMaxRegisters = 256;

  ExpressionRows() = default;
  /// Throws ExpressionFault when more than kMaxRegisters values are needed at once. No root may be a fault.
  ExpressionRows(const ExpressionGraph& graph, std::span<const Node> roots);

  /// Row i of a variable is data[i * stride]; stride 0: the same for all.
  struct Column {
    const double* data = nullptr;
    size_t stride = 0;
  };
  /// Where row i of a root is written: data[(i - begin) * stride].
  struct Output {
    double* data = nullptr;
    size_t stride = 1;
  };
  /// Rows [begin, end): variables[number] for every variable that occurs, outputs one per root.
  void run(std::span<const Column> variables, std::span<const Output> outputs, size_t begin,
           size_t end) const;
  /// True when the variable with that index occurs.
  bool uses(size_t variable) const;
  size_t outputs() const { return outputs_; }
  size_t instructions() const { return code_.size(); }
  size_t registers() const { return registers_; }

 private:
  struct Input {
    uint16_t to;
    int32_t variable;  ///< -1: the constant `value`
    double value;
  };
  struct Instruction {
    Operator op;
    uint16_t to, from[3];
    int32_t output;  ///< the root that this is, or -1
  };
  struct Store {
    uint16_t from;
    int32_t output;
  };
  static void load(const Column& column, double* to, size_t begin, size_t rows);

  std::vector<Input> inputs_;
  std::vector<Instruction> code_;
  std::vector<Store> stores_;  ///< roots that are inputs, or equal to another root
  size_t outputs_ = 0, registers_ = 0;
};

}  // namespace truestep
