#include "engine/math/expression/graph.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace truestep {

using O = Operator;
using Node = ExpressionGraph::Node;

namespace {

uint64_t mix(uint64_t h) {
  h ^= h >> 31;
  h *= 0x9e3779b97f4a7c15ull;
  return h ^ h >> 29;
}

uint64_t hash_of(const ExpressionGraph::Entry& e) {
  uint64_t h = mix(static_cast<uint64_t>(e.op) + 0x1234567);
  h = mix(h ^ static_cast<uint32_t>(e.a));
  h = mix(h ^ static_cast<uint64_t>(static_cast<uint32_t>(e.b)) << 20);
  h = mix(h ^ static_cast<uint64_t>(static_cast<uint32_t>(e.c)) << 7);
  return mix(h ^ std::bit_cast<uint64_t>(e.value));
}

bool same(const ExpressionGraph::Entry& p, const ExpressionGraph::Entry& q) {
  return p.op == q.op && p.a == q.a && p.b == q.b && p.c == q.c &&
         std::bit_cast<uint64_t>(p.value) == std::bit_cast<uint64_t>(q.value);
}

/// Addition and similar: the order of the operands does not change the bits.
bool commutes(O op) {
  return op == O::add || op == O::multiply || op == O::equal || op == O::not_equal || op == O::both ||
         op == O::either;
}

bool power_of_two(double c) {
  int exponent;
  return std::isnormal(c) && std::isnormal(1 / c) && std::fabs(std::frexp(c, &exponent)) == 0.5;
}

}  // namespace

void ExpressionGraph::charge(size_t position) {
  if (++work_ > kMaxWork)
    throw ExpressionFault{
        position, "the equations expand to more than " + std::to_string(kMaxWork) + " operations", ""};
}

Node ExpressionGraph::intern(Entry e) {
  if (2 * entries_.size() + 2 > table_.size()) rehash();
  const size_t mask = table_.size() - 1;
  size_t slot = hash_of(e) & mask;
  while (table_[slot] != kNone) {
    if (same(entries_[static_cast<size_t>(table_[slot])], e)) return table_[slot];
    slot = (slot + 1) & mask;
  }
  if (entries_.size() >= kMaxNodes)
    throw ExpressionFault{0, "the equations need more than " + std::to_string(kMaxNodes) + " operations", ""};
  table_[slot] = static_cast<Node>(entries_.size());
  entries_.push_back(e);
  return table_[slot];
}

void ExpressionGraph::rehash() {
  table_.assign(std::max<size_t>(64, 2 * table_.size()), kNone);
  const size_t mask = table_.size() - 1;
  for (size_t i = 0; i < entries_.size(); ++i) {
    size_t slot = hash_of(entries_[i]) & mask;
    while (table_[slot] != kNone) slot = (slot + 1) & mask;
    table_[slot] = static_cast<Node>(i);
  }
}

std::optional<double> ExpressionGraph::constant_value(Node n) const {
  return at(n).op == O::constant ? std::optional(at(n).value) : std::nullopt;
}

const ExpressionFault* ExpressionGraph::fault_of(Node n) const {
  return at(n).op == O::fault ? &faults_[static_cast<size_t>(at(n).a)] : nullptr;
}

Node ExpressionGraph::constant(double value) {
  return intern({O::constant, kNone, kNone, kNone, value});
}

Node ExpressionGraph::variable(int32_t number) {
  return intern({O::variable, number});
}

Node ExpressionGraph::fault(ExpressionFault why) {
  faults_.push_back(std::move(why));
  return intern({O::fault, static_cast<Node>(faults_.size() - 1)});
}

Node ExpressionGraph::unary(O op, Node a) {
  const Entry e = at(a);
  if (e.op == O::fault) return a;
  if (e.op == O::constant) return constant(apply(op, e.value, 0, 0));
  if (op == O::negate && e.op == O::negate) return e.a;
  if (op == O::abs && e.op == O::negate) return unary(O::abs, e.a);
  // |a - b| = |b - a| to the bit.
  if (op == O::abs && e.op == O::subtract && e.a > e.b) return unary(O::abs, binary(O::subtract, e.b, e.a));
  return intern({op, a});
}

Node ExpressionGraph::binary(O op, Node a, Node b) {
  const Entry ea = at(a), eb = at(b);
  const auto ca = constant_value(a), cb = constant_value(b);
  // A decided condition drops the other side, faults and all.
  if (op == O::both && ((ca && *ca == 0) || (cb && *cb == 0))) return constant(0);
  if (op == O::either && ((ca && *ca != 0) || (cb && *cb != 0))) return constant(1);
  if (ea.op == O::fault) return a;
  if (eb.op == O::fault) return b;
  if (ca && cb) return constant(apply(op, *ca, *cb, 0));
  if (op == O::power) return power(a, b);
  if (op == O::multiply || op == O::divide) {
    if (cb && *cb == 1) return a;
    if (op == O::multiply && ca && *ca == 1) return b;
    if (op == O::divide && cb && power_of_two(*cb)) return binary(O::multiply, a, constant(1 / *cb));
    if (op == O::multiply && a == b) {
      if (ea.op == O::negate) return binary(O::multiply, ea.a, ea.a);
      if (ea.op == O::subtract && ea.a > ea.b) {
        const Node d = binary(O::subtract, ea.b, ea.a);
        return binary(O::multiply, d, d);
      }
    }
  }
  if (op == O::subtract && cb && *cb == 0 && !std::signbit(*cb)) return a;
  if (op == O::subtract && eb.op == O::negate) return binary(O::add, a, eb.a);
  if (op == O::add && eb.op == O::negate) return binary(O::subtract, a, eb.a);
  if (op == O::add && ea.op == O::negate) return binary(O::subtract, b, ea.a);
  if (commutes(op) && a > b) std::swap(a, b);
  return intern({op, a, b});
}

Node ExpressionGraph::choose(Node condition, Node a, Node b) {
  if (fault_of(condition)) return condition;
  if (const auto c = constant_value(condition)) return *c != 0 ? a : b;
  if (fault_of(a)) return a;
  if (fault_of(b)) return b;
  return a == b ? a : intern({O::choose, condition, a, b});
}

Node ExpressionGraph::integer_power(Node a, int n) {
  // By squaring, in the order r = 1; for each bit of n, lowest first: r *= s when it is set; s *= s.
  Node result = kNone, square = a;
  for (int k = n < 0 ? -n : n; k > 0; k >>= 1) {
    if (k & 1) result = result == kNone ? square : binary(O::multiply, result, square);
    if (k > 1) square = binary(O::multiply, square, square);
  }
  if (result == kNone) return constant(1);
  return n < 0 ? binary(O::divide, constant(1), result) : result;
}

Node ExpressionGraph::power(Node a, Node b) {
  if (fault_of(a)) return a;
  const auto n = constant_value(b);
  if (n && *n == std::floor(*n) && std::fabs(*n) <= 64) return integer_power(a, static_cast<int>(*n));
  if (n && 2 * *n == std::floor(2 * *n) && std::fabs(*n) <= 64) {
    // x^(k + 1/2) = x^k sqrt(x), its reciprocal below 0.
    const int k = static_cast<int>(std::floor(std::fabs(*n)));
    const Node root = unary(O::sqrt, a);
    const Node p = k == 0 ? root : binary(O::multiply, integer_power(a, k), root);
    return *n < 0 ? binary(O::divide, constant(1), p) : p;
  }
  if (fault_of(b)) return b;
  if (const auto x = constant_value(a); x && n) return constant(apply(O::power, *x, *n, 0));
  return intern({O::power, a, b});
}

std::vector<int32_t> ExpressionGraph::variables_of(std::span<const Node> roots) const {
  std::vector<uint8_t> seen(entries_.size());
  std::vector<Node> stack(roots.begin(), roots.end());
  std::vector<int32_t> found;
  while (!stack.empty()) {
    const Node n = stack.back();
    stack.pop_back();
    if (seen[static_cast<size_t>(n)]) continue;
    seen[static_cast<size_t>(n)] = 1;
    const Entry& e = at(n);
    if (e.op == O::variable) found.push_back(e.a);
    if (arity(e.op) > 0) stack.push_back(e.a);
    if (arity(e.op) > 1) stack.push_back(e.b);
    if (arity(e.op) > 2) stack.push_back(e.c);
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace truestep
