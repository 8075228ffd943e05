// Pairs of bodies that have met during a step: when, how fast they parted, and whether they rest against each
// other for the rest of it.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

namespace truestep::nbody {

struct MetPair {
  uint32_t a, b;
  double when, parted;  ///< s, m/s
  bool resting;
};

class MetPairs {
 public:
  void clear() { pairs_.clear(); }
  MetPair* find(uint32_t a, uint32_t b) {
    const auto at = std::ranges::find_if(pairs_, [&](const MetPair& p) { return p.a == a && p.b == b; });
    return at == pairs_.end() ? nullptr : &*at;
  }
  MetPair& of(uint32_t a, uint32_t b) {
    if (MetPair* p = find(a, b)) return *p;
    return pairs_.emplace_back(a, b, -1.0, 0.0, false);
  }
  bool resting(uint32_t a, uint32_t b) {
    const MetPair* p = find(a, b);
    return p && p->resting;
  }
  std::vector<MetPair>& all() { return pairs_; }

 private:
  std::vector<MetPair> pairs_;
};

}  // namespace truestep::nbody
