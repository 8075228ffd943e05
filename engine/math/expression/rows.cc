#include "engine/math/expression/rows.h"

#include <algorithm>
#include <array>

#include "engine/math/trig_rows.h"

namespace truestep {

using O = Operator;
using Node = ExpressionGraph::Node;

namespace {

constexpr size_t kBlock = ExpressionRows::kBlock;

/// One operation on a block; the result may overwrite an operand.
template <O op>
void block(double* to, const double* a, const double* b, const double* c) {
  if constexpr (op == O::sin) return trig::sin_rows(a, to, kBlock);
  if constexpr (op == O::cos) return trig::cos_rows(a, to, kBlock);
#pragma GCC ivdep
  for (size_t k = 0; k < kBlock; ++k) {
    to[k] = apply<op>(a[k], arity(op) > 1 ? b[k] : 0, arity(op) > 2 ? c[k] : 0);
  }
}

void store(const double* from, const ExpressionRows::Output& out, size_t first, size_t rows) {
  double* to = out.data + first * out.stride;
  if (out.stride == 1) {
    std::copy_n(from, rows, to);
  } else {
    for (size_t k = 0; k < rows; ++k) to[k * out.stride] = from[k];
  }
}

/// Hands out registers, the most recently freed first.
class Registers {
 public:
  uint16_t take() {
    if (!free_.empty()) {
      const uint16_t r = free_.back();
      free_.pop_back();
      return r;
    }
    if (count_ == ExpressionRows::kMaxRegisters) {
      throw ExpressionFault{0,
                            "the expressions need more than " +
                                std::to_string(ExpressionRows::kMaxRegisters) + " values at once",
                            ""};
    }
    return static_cast<uint16_t>(count_++);
  }
  void give_back(uint16_t r) { free_.push_back(r); }
  size_t count() const { return count_; }

 private:
  std::vector<uint16_t> free_;
  size_t count_ = 0;
};

}  // namespace

ExpressionRows::ExpressionRows(const ExpressionGraph& graph, std::span<const Node> roots)
    : outputs_(roots.size()) {
  const Node last = roots.empty() ? -1 : *std::max_element(roots.begin(), roots.end());
  // Index of each node's last reader; operands come before their readers.
  std::vector<Node> reader(static_cast<size_t>(last) + 1, ExpressionGraph::kNone);
  std::vector<int32_t> root_of(reader.size(), -1);
  for (size_t k = 0; k < roots.size(); ++k) {
    const auto i = static_cast<size_t>(roots[k]);
    reader[i] = std::max(reader[i], roots[k]);
    if (root_of[i] >= 0) reader[i] = last + 1;
    root_of[i] = static_cast<int32_t>(k);
  }
  const auto operands = [&graph](Node n) {
    const auto& e = graph.at(n);
    const int count = arity(e.op);
    return std::array<Node, 3>{count > 0 ? e.a : -1, count > 1 ? e.b : -1, count > 2 ? e.c : -1};
  };
  for (Node n = last; n >= 0; --n) {
    if (reader[static_cast<size_t>(n)] == ExpressionGraph::kNone) continue;
    for (const Node m : operands(n)) {
      if (m >= 0) reader[static_cast<size_t>(m)] = std::max(reader[static_cast<size_t>(m)], n);
    }
  }
  Registers registers;
  std::vector<uint16_t> place(reader.size());
  for (Node n = 0; n <= last; ++n) {
    const auto i = static_cast<size_t>(n);
    const auto& e = graph.at(n);
    if (reader[i] == ExpressionGraph::kNone || arity(e.op) > 0) continue;
    place[i] = registers.take();
    inputs_.push_back({place[i], e.op == O::variable ? e.a : -1, e.value});
  }
  for (Node n = 0; n <= last; ++n) {
    const auto i = static_cast<size_t>(n);
    if (reader[i] == ExpressionGraph::kNone || arity(graph.at(n).op) == 0) continue;
    Instruction in{graph.at(n).op, 0, {0, 0, 0}, reader[i] <= last ? root_of[i] : -1};
    const auto from = operands(n);
    for (size_t k = 0; k < 3 && from[k] >= 0; ++k) {
      const auto m = static_cast<size_t>(from[k]);
      in.from[k] = place[m];
      const bool again = k > 0 && (from[0] == from[k] || (k > 1 && from[1] == from[k]));
      if (reader[m] == n && arity(graph.at(from[k]).op) > 0 && !again) registers.give_back(place[m]);
    }
    in.to = place[i] = registers.take();
    if (reader[i] == n) registers.give_back(place[i]);  // a root that nothing else reads
    code_.push_back(in);
  }
  for (size_t k = 0; k < roots.size(); ++k) {
    const auto i = static_cast<size_t>(roots[k]);
    if (arity(graph.at(roots[k]).op) == 0 || reader[i] > last) {
      stores_.push_back({place[i], static_cast<int32_t>(k)});
    }
  }
  registers_ = registers.count();
}

bool ExpressionRows::uses(size_t variable) const {
  return std::any_of(inputs_.begin(), inputs_.end(), [variable](const Input& in) {
    return in.variable >= 0 && static_cast<size_t>(in.variable) == variable;
  });
}

void ExpressionRows::load(const Column& column, double* to, size_t begin, size_t rows) {
  const double* from = column.data + begin * column.stride;
  for (size_t k = 0; k < rows; ++k) to[k] = from[k * column.stride];
  // Lanes beyond the last row compute on copies of it.
  for (size_t k = rows; k < kBlock; ++k) to[k] = to[rows - 1];
}

void ExpressionRows::run(std::span<const Column> variables, std::span<const Output> outputs, size_t begin,
                         size_t end) const {
  alignas(64) double memory[kMaxRegisters * kBlock];
  const auto at = [&memory](uint16_t r) { return memory + r * kBlock; };
  for (const Input& in : inputs_) {
    const bool same = in.variable < 0 || variables[static_cast<size_t>(in.variable)].stride == 0;
    if (!same) continue;
    std::fill_n(at(in.to), kBlock,
                in.variable < 0 ? in.value : *variables[static_cast<size_t>(in.variable)].data);
  }
  for (size_t i = begin; i < end; i += kBlock) {
    const size_t rows = std::min(kBlock, end - i);
    for (const Input& in : inputs_) {
      if (in.variable < 0) continue;
      const Column& column = variables[static_cast<size_t>(in.variable)];
      if (column.stride > 0) load(column, at(in.to), i, rows);
    }
    for (const Instruction& in : code_) {
      double* to = at(in.to);
      dispatch(in.op, [&]<O op>() { block<op>(to, at(in.from[0]), at(in.from[1]), at(in.from[2])); });
      if (in.output >= 0) store(to, outputs[static_cast<size_t>(in.output)], i - begin, rows);
    }
    for (const Store& s : stores_) store(at(s.from), outputs[static_cast<size_t>(s.output)], i - begin, rows);
  }
}

}  // namespace truestep
