#include "engine/math/expression/program.h"

#include <algorithm>
#include <array>

#include "engine/math/lanes.h"

namespace truestep {

using O = Operator;
using Node = ExpressionGraph::Node;

namespace {

constexpr size_t kLanes = 4;
/// Fewer equal operations than this stay scalar.
constexpr size_t kWorthLanes = 3;
/// Neighbouring operands of at least this many operations get an instruction of their own.
constexpr size_t kLongRun = 8;

uint32_t round_up(uint32_t n) {
  return (n + kLanes - 1) / kLanes * kLanes;
}

/// Operations that Lanes4 has; the others go lane by lane.
constexpr bool vectorised(O op) {
  return op == O::add || op == O::subtract || op == O::multiply || op == O::divide || op == O::sqrt ||
         op == O::negate;
}

template <O op>
Lanes4 apply4(Lanes4 a, Lanes4 b) {
  if constexpr (op == O::add) return a + b;
  if constexpr (op == O::subtract) return a - b;
  if constexpr (op == O::multiply) return a * b;
  if constexpr (op == O::divide) return a / b;
  if constexpr (op == O::sqrt) return sqrt(a);
  if constexpr (op == O::negate) return -a;
  return a;
}

}  // namespace

/// The loops of vector instructions.
struct ExpressionProgram::Kernels {
  template <Source source>
  static Lanes4 load(const double* r, const uint32_t* lists, uint32_t from, uint32_t k) {
    if constexpr (source == Source::neighbours) return Lanes4::load(r + from + k);
    if constexpr (source == Source::one) return Lanes4::all(r[from]);
    return Lanes4::gather(r, lists + from + k);
  }

  template <O op, Source sa, Source sb>
  static void wide(const Instruction& in, double* r, const uint32_t* lists) {
    // Lanes beyond the last result are padding, in registers and lists alike.
    for (uint32_t k = 0; k < in.lanes; k += kLanes) {
      const Lanes4 a = load<sa>(r, lists, in.from[0], k);
      apply4<op>(a, arity(op) == 2 ? load<sb>(r, lists, in.from[1], k) : a).store(r + in.to + k);
    }
  }
  template <O op, Source sa>
  static void wide(const Instruction& in, double* r, const uint32_t* lists) {
    if (arity(op) == 1) return wide<op, sa, Source::one>(in, r, lists);
    switch (in.b) {
      case Source::neighbours:
        return wide<op, sa, Source::neighbours>(in, r, lists);
      case Source::one:
        return wide<op, sa, Source::one>(in, r, lists);
      case Source::scattered:
        return wide<op, sa, Source::scattered>(in, r, lists);
    }
  }
  template <O op>
  static void run(const Instruction& in, double* r, const uint32_t* lists) {
    if constexpr (vectorised(op)) {
      switch (in.a) {
        case Source::neighbours:
          return wide<op, Source::neighbours>(in, r, lists);
        case Source::one:
          return wide<op, Source::one>(in, r, lists);
        case Source::scattered:
          return wide<op, Source::scattered>(in, r, lists);
      }
    } else {
      // All operands of such an instruction are lists.
      const uint32_t *a = lists + in.from[0], *b = lists + in.from[1], *c = lists + in.from[2];
      for (uint32_t k = 0; k < in.lanes; ++k) {
        r[in.to + k] = apply<op>(r[a[k]], arity(op) > 1 ? r[b[k]] : 0, arity(op) > 2 ? r[c[k]] : 0);
      }
    }
  }
  [[gnu::noinline]] static void run(const Instruction& in, double* r, const uint32_t* lists) {
    dispatch(in.op, [&]<O op>() { run<op>(in, r, lists); });
  }
};

/// Builds the code of one program.
struct ExpressionProgram::Builder {
  ExpressionProgram& program;
  const ExpressionGraph& graph;
  std::vector<uint32_t> place{};  ///< register of every node

  std::array<uint32_t, 3> operands(Node n) const {
    const auto& e = graph.at(n);
    const auto at = [&](Node m) { return m == ExpressionGraph::kNone ? 0 : place[static_cast<size_t>(m)]; };
    return {at(e.a), at(e.b), at(e.c)};
  }
  void align() { program.registers_ = round_up(static_cast<uint32_t>(program.registers_)); }

  void scalars(std::span<const Node> nodes) {
    for (const Node n : nodes) {
      Instruction in{graph.at(n).op};
      in.to = place[static_cast<size_t>(n)] = static_cast<uint32_t>(program.registers_++);
      std::ranges::copy(operands(n), in.from);
      program.code_.push_back(in);
    }
  }
  /// Neighbouring results, padded only at the group's end: whatever a store writes beyond them is overwritten
  /// by what follows.
  void lanes(std::span<const Node> nodes) {
    if (nodes.size() < kWorthLanes) return scalars(nodes);
    Instruction in{graph.at(nodes[0]).op};
    in.lanes = static_cast<uint32_t>(nodes.size());
    in.to = static_cast<uint32_t>(program.registers_);
    Source* const sources[] = {&in.a, &in.b};
    for (int k = 0; k < arity(in.op); ++k) {
      std::vector<uint32_t> registers;
      for (const Node n : nodes) registers.push_back(operands(n)[static_cast<size_t>(k)]);
      if (vectorised(in.op)) {
        *sources[k] = find_source(registers, in.from[k]);
      } else {
        in.from[k] = static_cast<uint32_t>(program.lists_.size());
        program.lists_.insert(program.lists_.end(), registers.begin(), registers.end());
      }
    }
    for (const Node n : nodes) place[static_cast<size_t>(n)] = static_cast<uint32_t>(program.registers_++);
    program.code_.push_back(in);
  }
  Source find_source(const std::vector<uint32_t>& registers, uint32_t& from) const {
    bool same = true, neighbours = true;
    for (size_t k = 1; k < registers.size(); ++k) {
      same &= registers[k] == registers[0];
      neighbours &= registers[k] == registers[k - 1] + 1;
    }
    from = registers[0];
    if (same) return Source::one;
    if (neighbours) return Source::neighbours;
    auto& lists = program.lists_;
    from = static_cast<uint32_t>(lists.size());
    lists.insert(lists.end(), registers.begin(), registers.end());
    while ((lists.size() - from) % kLanes != 0) lists.push_back(registers.back());
    return Source::scattered;
  }

  /// Operations of one kind and depth: long runs with neighbouring (or common) operands become instructions
  /// of their own, the rest one instruction with scattered operands.
  void group(std::vector<Node>& nodes) {
    // Neighbouring operands make neighbouring results.
    std::stable_sort(nodes.begin(), nodes.end(), [&](Node p, Node q) { return operands(p) < operands(q); });
    if (nodes.size() < kWorthLanes) return scalars(nodes);
    align();
    std::vector<Node> rest;
    for (size_t begin = 0, end; begin < nodes.size(); begin = end) {
      end = run_end(nodes, begin);
      const auto run = std::span(nodes).subspan(begin, end - begin);
      if (run.size() >= kLongRun || run.size() == nodes.size()) {
        lanes(run);
      } else {
        rest.insert(rest.end(), run.begin(), run.end());
      }
    }
    if (!rest.empty()) lanes(rest);
    align();
  }
  size_t run_end(std::span<const Node> nodes, size_t begin) const {
    if (begin + 1 == nodes.size()) return begin + 1;
    const auto first = operands(nodes[begin]), second = operands(nodes[begin + 1]);
    std::array<uint32_t, 3> step;
    for (size_t k = 0; k < 3; ++k) {
      step[k] = second[k] - first[k];
      if (step[k] > 1) return begin + 1;
    }
    size_t end = begin + 2;
    for (; end < nodes.size(); ++end) {
      const auto before = operands(nodes[end - 1]), here = operands(nodes[end]);
      for (size_t k = 0; k < 3; ++k) {
        if (here[k] - before[k] != step[k]) return end;
      }
    }
    return end;
  }

  /// Merges scalar products whose only reader is a scalar sum into that sum.
  void join_products() {
    std::vector<uint32_t> readers(program.registers_);
    for (const Instruction& in : program.code_) {
      for (int k = 0; k < arity(in.op); ++k) {
        const Source source = k == 0 ? in.a : in.b;
        if (in.lanes == 1 || (vectorised(in.op) && source == Source::one)) {
          ++readers[in.from[k]];
        } else if (!vectorised(in.op) || source == Source::scattered) {
          for (uint32_t i = 0; i < in.lanes; ++i) ++readers[program.lists_[in.from[k] + i]];
        } else {
          for (uint32_t i = 0; i < in.lanes; ++i) ++readers[in.from[k] + i];
        }
      }
    }
    for (const Copy& c : program.copies_) {
      for (uint32_t i = 0; i < c.count; ++i) ++readers[c.from + i];
    }
    std::vector<const Instruction*> product(program.registers_);
    std::vector<Instruction> joined;
    for (const Instruction& in : program.code_) {
      if (in.lanes == 1 && in.op == O::multiply && readers[in.to] == 1) product[in.to] = &in;
    }
    std::vector<uint8_t> gone(program.registers_);
    for (Instruction& in : program.code_) {
      if (in.lanes > 1 || (in.op != O::add && in.op != O::subtract)) continue;
      const Instruction *left = product[in.from[0]], *right = product[in.from[1]];
      if (!left && !right) continue;
      const Instruction& p = left ? *left : *right;
      gone[p.to] = 1;
      const uint32_t other = in.from[left ? 1 : 0];
      in.op = in.op == O::add ? O::multiply_add : left ? O::multiply_subtract : O::subtract_multiply;
      in.from[0] = p.from[0], in.from[1] = p.from[1], in.from[2] = other;
    }
    std::erase_if(program.code_, [&](const Instruction& in) { return in.lanes == 1 && gone[in.to]; });
  }
};

ExpressionProgram::ExpressionProgram(const ExpressionGraph& graph, std::span<const Node> roots,
                                     size_t variables)
    : outputs_(roots.size()) {
  // Nodes come after their operands, so one pass down marks the cone and one pass up finds the depths.
  const Node last = roots.empty() ? -1 : *std::max_element(roots.begin(), roots.end());
  std::vector<uint8_t> used(static_cast<size_t>(last) + 1);
  for (const Node n : roots) used[static_cast<size_t>(n)] = 1;
  for (Node n = last; n >= 0; --n) {
    const auto& e = graph.at(n);
    if (!used[static_cast<size_t>(n)]) continue;
    if (arity(e.op) > 0) used[static_cast<size_t>(e.a)] = 1;
    if (arity(e.op) > 1) used[static_cast<size_t>(e.b)] = 1;
    if (arity(e.op) > 2) used[static_cast<size_t>(e.c)] = 1;
  }
  Builder build{*this, graph};
  build.place.resize(used.size());
  std::vector<uint32_t> depth(used.size());
  std::vector<Node> operations;
  registers_ = round_up(static_cast<uint32_t>(variables));
  for (Node n = 0; n <= last; ++n) {
    const auto i = static_cast<size_t>(n);
    if (!used[i]) continue;
    const auto& e = graph.at(n);
    if (e.op == O::variable) {
      build.place[i] = static_cast<uint32_t>(e.a);
    } else if (e.op == O::constant) {
      build.place[i] = static_cast<uint32_t>(registers_++);
      constants_.emplace_back(build.place[i], e.value);
    } else {
      const auto below = [&](Node m) { return depth[static_cast<size_t>(m)]; };
      depth[i] = 1 + below(e.a);
      if (arity(e.op) > 1) depth[i] = std::max(depth[i], 1 + below(e.b));
      if (arity(e.op) > 2) depth[i] = std::max(depth[i], 1 + below(e.c));
      operations.push_back(n);
    }
  }
  build.align();
  const auto kind = [&](Node n) { return std::pair(depth[static_cast<size_t>(n)], graph.at(n).op); };
  std::stable_sort(operations.begin(), operations.end(), [&](Node p, Node q) { return kind(p) < kind(q); });
  std::vector<Node> group;
  for (size_t k = 0; k < operations.size(); ++k) {
    group.push_back(operations[k]);
    if (k + 1 < operations.size() && kind(operations[k + 1]) == kind(operations[k])) continue;
    build.group(group);
    group.clear();
  }
  registers_ += kLanes;  // a vector load may read beyond the last register
  for (size_t k = 0; k < roots.size(); ++k) {
    const uint32_t from = build.place[static_cast<size_t>(roots[k])];
    if (!copies_.empty() && copies_.back().from + copies_.back().count == from) {
      ++copies_.back().count;
    } else {
      copies_.push_back({static_cast<uint32_t>(k), from, 1});
    }
  }
  build.join_products();
}

size_t ExpressionProgram::memory_bytes() const {
  return code_.size() * sizeof(Instruction) + lists_.size() * 4 + constants_.size() * 16 +
         copies_.size() * sizeof(Copy) + registers_ * 8;
}

void ExpressionProgram::start(double* r) const {
  std::fill_n(r, registers_, 1.0);
  for (const auto& [place, value] : constants_) r[place] = value;
}

void ExpressionProgram::run(double* r, double* out) const {
  const uint32_t* lists = lists_.data();
  const Instruction* const end = code_.data() + code_.size();
  for (const Instruction* in = code_.data(); in != end; ++in) {
    if (in->lanes == 1) [[likely]] {
      const double a = r[in->from[0]], b = r[in->from[1]], c = r[in->from[2]];
      r[in->to] = apply(in->op, a, b, c);
    } else {
      Kernels::run(*in, r, lists);
    }
  }
  for (const Copy& c : copies_) {
    double* to = out + c.to;
    const double* from = r + c.from;
    for (uint32_t k = 0; k < c.count; ++k) to[k] = from[k];
  }
}

}  // namespace truestep
