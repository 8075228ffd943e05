// A vector of expressions compiled to register code and evaluated at one point. Nodes of equal depth with the
// same operation, whichever components they belong to, become one instruction over neighbouring registers:
// seven bodies' forces or a thousand springs run in SIMD lanes although each was written as scalar text.
// Single operations become scalar instructions. Immutable; scratch belongs to the caller.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/math/expression/graph.h"

namespace truestep {

class ExpressionProgram {
 public:
  using Node = ExpressionGraph::Node;

  ExpressionProgram() = default;
  /// Registers [0, variables) hold the graph's variables. No root may be a fault.
  ExpressionProgram(const ExpressionGraph& graph, std::span<const Node> roots, size_t variables);

  size_t outputs() const { return outputs_; }
  /// Doubles of scratch that `start` and `run` use.
  size_t registers() const { return registers_; }
  size_t instructions() const { return code_.size(); }
  size_t memory_bytes() const;

  /// Once per scratch: writes the constants.
  void start(double* registers) const;
  /// Reads the variables from registers [0, variables), writes `outputs` values, which must not overlap them.
  void run(double* registers, double* out) const;

 private:
  enum class Source : uint8_t { neighbours, one, scattered };  ///< where an instruction's lanes come from
  struct Instruction {
    Operator op;
    Source a = Source::one, b = Source::one;
    uint32_t lanes = 1;     ///< number of results; 1: a scalar instruction
    uint32_t to = 0;        ///< first register of the results
    uint32_t from[3] = {};  ///< first register, the register, or the first entry of `lists_`
  };
  struct Copy {
    uint32_t to, from, count;
  };
  struct Kernels;
  struct Builder;

  std::vector<Instruction> code_;
  std::vector<uint32_t> lists_;
  std::vector<std::pair<uint32_t, double>> constants_;
  std::vector<Copy> copies_;
  size_t outputs_ = 0, registers_ = 0;
};

}  // namespace truestep
