#include "engine/collision/broad/broad_phase.h"

#include <algorithm>
#include <utility>

namespace truestep {
namespace {

uint64_t key(uint32_t a, uint32_t b) {
  return a < b ? uint64_t{a} << 32 | b : uint64_t{b} << 32 | a;
}
/// Number of updates for which a body is assumed to keep its motion, and the maximum distance of that motion
/// in body sizes.
constexpr float kAhead = 4, kMostAhead = 1;

/// The grown box, extended ahead by the body's motion since the last update.
FloatBox ahead(FloatBox grown, const FloatBox& before, const FloatBox& now) {
  for (int k = 0; k < 3; ++k) {
    const float most = kMostAhead * (now.high[k] - now.low[k]);
    const float shift = kAhead * 0.5f * ((now.low[k] - before.low[k]) + (now.high[k] - before.high[k]));
    grown.low[k] += std::clamp(shift, -most, 0.0f), grown.high[k] += std::clamp(shift, 0.0f, most);
  }
  return grown;
}

BodyPair pair_of(uint64_t k) {
  return {static_cast<uint32_t>(k >> 32), static_cast<uint32_t>(k)};
}

}  // namespace

std::span<const BodyPair> BroadPhase::update(std::span<const Box> boxes, std::span<const Mobility> mobility,
                                             double margin) {
  sort_in(boxes, mobility, margin);
  renew_candidates(mobility);
  test_candidates(mobility);
  return pairs_;
}

/// Sorts in bodies that left their grown boxes, appeared, disappeared or changed mobility.
void BroadPhase::sort_in(std::span<const Box> boxes, std::span<const Mobility> mobility, double margin) {
  const size_t n = boxes.size(), before = tight_.size();
  moved_list_.clear();
  unbounded_.clear();
  moved_.assign(std::max(n, before), 0);
  tight_.resize(n);
  left_.clear();
  const auto move = [&](uint32_t i) {
    if (!moved_[i]) moved_list_.push_back(i);
    moved_[i] = 1;
  };
  for (auto i = static_cast<uint32_t>(n); i < before; ++i) {
    for (DynamicTree& t : trees_) {
      if (t.holds(i)) t.remove(i), move(i);
    }
  }
  // Many at once are cheaper to rebuild than to insert one by one.
  size_t entering = 0;
  for (uint32_t i = 0; i < n; ++i) {
    const Box& b = boxes[i];
    const FloatBox last = std::exchange(tight_[i], FloatBox::around(b));
    DynamicTree &own = tree(mobility[i]),
                &other = tree(mobility[i] == Mobility::fixed ? Mobility::moving : Mobility::fixed);
    if (other.holds(i)) other.remove(i), move(i);
    const bool there = b.low.x <= b.high.x && b.low.y <= b.high.y && b.low.z <= b.high.z;
    const bool bounded = there && b.finite();
    if (own.holds(i)) {
      if (bounded && own.box(i).contains(tight_[i])) continue;
      move(i);
      if (!bounded) own.remove(i);
      if (bounded) left_.push_back({i, last});
    }
    if (there && !bounded) unbounded_.push_back(i);
    if (bounded) move(i), ++entering;
  }
  size_t held = trees_[0].size() + trees_[1].size();
  const bool anew = entering > 256 && 4 * entering > held;
  auto left = left_.begin();
  for (const uint32_t i : moved_list_) {
    if (i >= n || !(tight_[i].low[0] <= tight_[i].high[0]) || !boxes[i].finite()) continue;
    FloatBox grown = FloatBox::around(boxes[i].grown(margin));
    while (left != left_.end() && left->body < i) ++left;
    if (left != left_.end() && left->body == i) grown = ahead(grown, left->box, tight_[i]);
    DynamicTree& t = tree(mobility[i]);
    if (anew) {
      t.set(i, grown);
    } else {
      if (t.holds(i)) t.remove(i);
      t.insert(i, grown);
    }
  }
  if (anew) {
    for (DynamicTree& t : trees_) t.rebuild();
  }
}

/// Pairs of grown boxes: those of bodies that stayed remain valid, bodies that moved are queried again.
void BroadPhase::renew_candidates(std::span<const Mobility> mobility) {
  if (moved_list_.empty()) return;
  const auto stale = [&](uint64_t k) { return moved_[k >> 32] || moved_[static_cast<uint32_t>(k)]; };
  candidates_.erase(std::remove_if(candidates_.begin(), candidates_.end(), stale), candidates_.end());
  fresh_.clear();
  for (const uint32_t i : moved_list_) {
    if (i >= mobility.size()) continue;
    const DynamicTree& own = tree(mobility[i]);
    if (!own.holds(i)) continue;
    const FloatBox box = own.box(i);
    const auto found = [&](uint32_t j) {
      // Two moved bodies find each other twice.
      if (j != i && !(moved_[j] && j < i)) fresh_.push_back(key(i, j));
    };
    tree(Mobility::moving).overlapping(box, found);
    if (mobility[i] == Mobility::moving) tree(Mobility::fixed).overlapping(box, found);
  }
  std::sort(fresh_.begin(), fresh_.end());
  merged_.resize(candidates_.size() + fresh_.size());
  std::merge(candidates_.begin(), candidates_.end(), fresh_.begin(), fresh_.end(), merged_.begin());
  candidates_.swap(merged_);
}

void BroadPhase::test_candidates(std::span<const Mobility> mobility) {
  pairs_.resize(candidates_.size());
  size_t count = 0;
  for (const uint64_t k : candidates_) {
    const BodyPair p = pair_of(k);
    pairs_[count] = p;
    count += tight_[p.a].overlaps(tight_[p.b]) ? 1 : 0;
  }
  pairs_.resize(count);
  if (unbounded_.empty()) return;
  fresh_.clear();
  for (const uint32_t u : unbounded_) {
    for (uint32_t i = 0; i < tight_.size(); ++i) {
      const bool both_fixed = mobility[u] == Mobility::fixed && mobility[i] == Mobility::fixed;
      const bool twice = i < u && std::binary_search(unbounded_.begin(), unbounded_.end(), i);
      if (i != u && !both_fixed && !twice && tight_[i].low[0] <= tight_[i].high[0] &&
          tight_[u].overlaps(tight_[i])) {
        fresh_.push_back(key(u, i));
      }
    }
  }
  std::sort(fresh_.begin(), fresh_.end());
  const auto middle = static_cast<std::ptrdiff_t>(pairs_.size());
  for (const uint64_t k : fresh_) pairs_.push_back(pair_of(k));
  std::inplace_merge(pairs_.begin(), pairs_.begin() + middle, pairs_.end(),
                     [](const BodyPair& p, const BodyPair& q) { return key(p.a, p.b) < key(q.a, q.b); });
}

}  // namespace truestep
