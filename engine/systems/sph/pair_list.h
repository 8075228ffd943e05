// Neighbour lists as the passes read them: each entry a slot and the gradient of the kernel there times a
// particle's volume, in groups of as many entries as Wide has lanes. Passes are bound by memory, so entries
// are small: slots are stored as 16-bit offsets from the first of their group, and float gradients as 16-bit
// multiples of a unit, the steepest gradient over 32,700. Rounding is odd, so two neighbours have exactly
// opposite gradients and momentum is conserved; a list's sums (density's gradient, stiffness) use the rounded
// ones. A partial group is padded with its first slot and gradients of 0.
#pragma once
#include <algorithm>
#include <type_traits>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/kernels/sph/gather.h"

namespace truestep::sph {

template <class T>
using Aligned = std::vector<T, CacheLineAllocator<T>>;

/// Number of particles that share a part of the lists.
inline constexpr size_t kChunk = 256;

/// Whether gradients are rounded, and to how many steps from 0 to the kernel's steepest.
template <class T>
inline constexpr bool kRounded = sizeof(T) == 4;
inline constexpr double kGradientSteps = 32'700;

/// As many entries as Wide has lanes, in one run of memory that a pass reads from end to end. An entry is a
/// row of four numbers: the gradient in the fluid's `unit` (1/m), volume times that of W, and for floats the
/// slot as an offset from the first entry's. Sums over neighbours then need no transposing.
template <class T>
struct Group {
  static constexpr size_t kLanes = Wide<T>::kLanes;
  T g[kLanes][4];
  uint16_t slots[kLanes];  ///< offsets from the first entry's

  uint16_t above(size_t lane) const { return slots[lane]; }
  void set_above(size_t lane, uint16_t slot) { slots[lane] = slot, g[lane][3] = 0; }
};
template <>
struct Group<float> {
  int16_t g[8][4];

  uint16_t above(size_t lane) const { return static_cast<uint16_t>(g[lane][3]); }
  void set_above(size_t lane, uint16_t slot) { g[lane][3] = static_cast<int16_t>(slot); }
};
/// Acts as an array of a group's slots, from entry `first` on.
template <class T>
struct SlotsOf {
  const Group<T>& group;
  size_t first = 0;
  size_t operator[](size_t lane) const { return group.above(first + lane); }
};

/// Neighbour lists of kChunk particles. Entries are counted from 0; k is the first of a group.
template <class T>
struct Chunk {
  using W = Wide<T>;
  static constexpr size_t kLanes = W::kLanes;

  Aligned<Group<T>> groups;
  std::vector<uint32_t> base;  ///< slot of a group's first entry
  Aligned<T> s;                ///< 1/m^2, volume times dW/dr / r
  Aligned<T> w;                ///< 1, volume times W
  Aligned<T> q;                ///< 1, distance over the kernel's radius
  /// The list being made: slots, offsets (m) and squared distances (m^2).
  std::vector<uint32_t> near;
  Aligned<T> away[3], square;
  uint32_t first[kChunk + 1];
  /// The cells around the current one: positions (m), padded to whole groups with points far from everything,
  /// and slots. Slot i of the current cell is at i + own.
  Aligned<T> around[3];
  std::vector<uint32_t> around_slots;
  size_t around_count = 0, own = 0;

  Group<T>& group(size_t k) { return groups[k / kLanes]; }
  const Group<T>& group(size_t k) const { return groups[k / kLanes]; }
  /// Gradients along axis a, in units.
  W gradient(size_t a, size_t k) const {
    W out[3];
    load_rows3(group(k).g, out);
    return out[a];
  }
  /// numbers[slot].
  W of(const Aligned<T>& numbers, size_t k) const {
    return gather(numbers.data() + base[k / kLanes], SlotsOf<T>{group(k)});
  }
  /// out[c]: number c of rows[slot], rows of four.
  void rows_of(const Aligned<T>& rows, size_t k, W out[4]) const {
    gather_rows4(rows.data() + 4 * size_t{base[k / kLanes]}, SlotsOf<T>{group(k)}, out);
  }
  /// Over the entries from `begin` to `end`: sums of gradient times numbers[slot] (the fourth is unused).
  void sum_times(const Aligned<T>& numbers, size_t begin, size_t end, T out[4]) const {
    sum_rows(over(begin, end,
                  [&](size_t from, const SlotsOf<T>& slots) {
                    return numbers_by_fours(numbers.data() + from, slots);
                  }),
             out);
  }
  /// Sum of the products of gradients and rows[slot], for rows of four whose last number is 0.
  T sum_dot(const Aligned<T>& rows, size_t begin, size_t end) const {
    return sum(over(begin, end, [&](size_t from, const SlotsOf<T>& slots) {
      return rows_side_by_side(rows.data() + 4 * from, slots);
    }));
  }

  /// Packs the list in `near` and its companions, entries `begin` to `end`, into groups; returns the new end,
  /// a whole number of groups. Padding entries are `far` away (m^2).
  size_t pack(size_t begin, size_t end, T far, size_t extras) {
    for (size_t k = begin; k < end; k += kLanes) {
      const size_t at = k - begin;
      Group<T>& out = groups[k / kLanes];
      const uint32_t from = base[k / kLanes] = near[at];
      size_t full = 1;
      // A slot below the first wraps around to a large offset and is rejected as well.
      for (; full < kLanes && k + full < end && near[at + full] - from <= 0xffff; ++full) {
        out.set_above(full, static_cast<uint16_t>(near[at + full] - from));
      }
      out.set_above(0, 0);
      if (full == kLanes) continue;
      if (k + full < end) {
        need(begin, end, kLanes, extras);
        shift(at + full, end - begin, kLanes - full);
      }
      end += kLanes - full;
      Group<T>& filled = groups[k / kLanes];
      for (size_t lane = full; lane < kLanes; ++lane) {
        filled.set_above(lane, 0), near[at + lane] = from, square[at + lane] = far;
        for (auto& a : away) a[at + lane] = 0;
      }
    }
    return end;
  }

  /// Appends slots `begin` to `end` to the surroundings, their positions x moved by `shift` (m).
  template <size_t D>
  void put_around(const Aligned<T>* x, size_t begin, size_t end, const double* shift) {
    const size_t at = around_count, count = end - begin;
    around_count += count;
    if (around_slots.size() < around_count + kLanes) {
      const size_t room = around_count + around_count / 2 + kLanes;
      around_slots.resize(room);
      for (auto& a : around) a.resize(room);
    }
    for (size_t a = 0; a < D; ++a) {
      const T by = static_cast<T>(shift[a]), *from = x[a].data() + begin;
      T* to = around[a].data() + at;
      for (size_t k = 0; k < count; ++k) to[k] = from[k] + by;
    }
    for (size_t k = 0; k < count; ++k) around_slots[at + k] = static_cast<uint32_t>(begin + k);
  }
  void end_around() {
    const size_t end = (around_count + kLanes - 1) / kLanes * kLanes;
    for (auto& a : around)
      std::fill(a.begin() + static_cast<ptrdiff_t>(around_count), a.begin() + static_cast<ptrdiff_t>(end),
                kFar);
    around_count = end;
  }

  /// Room for `more` entries after `used`, where those from `begin` on are one list; `extras` says whether
  /// slopes and weights, and distances, are kept with the gradients.
  void need(size_t begin, size_t used, size_t more, size_t extras) {
    constexpr size_t kLeastList = 512;
    const size_t least = used + more + 2 * kLanes, list = least - begin;
    if (near.size() < list) {
      const size_t room = std::max(list + list / 2, kLeastList);
      near.resize(room), square.resize(room);
      for (auto& a : away) a.resize(room);
    }
    if (kLanes * groups.size() >= least) return;
    const size_t room = (least + least / 2) / kLanes * kLanes;
    groups.resize(room / kLanes), base.resize(room / kLanes);
    if (extras > 0) s.resize(room), w.resize(room);
    if (extras > 1) q.resize(room);
  }

 private:
  static constexpr T kFar = T(1e18);  ///< m
  /// Sums of entries times factor(slot of the first, offsets): four of them, so no product waits for the one
  /// before.
  template <class Factor>
  W over(size_t begin, size_t end, const Factor& factor) const {
    // Lists are larger than the caches: a group fetched this far ahead has arrived when it is needed.
    constexpr size_t kSums = 4, kAhead = 16;
    W sums[kSums];
    for (auto& s : sums) s = W::zero();
    for (size_t k = begin / kLanes; k != end / kLanes; ++k) {
      const Group<T>& g = groups[k];
      __builtin_prefetch(&g + kAhead);
      const size_t from = base[k];
      for (size_t p = 0; p < kSums; ++p) {
        const size_t lane = p * kRowsSide<T>;
        sums[p] = madd(load_as<T>(g.g[lane]), factor(from, SlotsOf<T>{g, lane}), sums[p]);
      }
    }
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
  }
  /// Moves the list's entries from `from` to `end` up by `by`.
  void shift(size_t from, size_t end, size_t by) {
    const auto move = [&](auto& a) { std::copy_backward(&a[from], &a[0] + end, &a[0] + end + by); };
    move(near), move(square);
    for (auto& a : away) move(a);
  }
};

}  // namespace truestep::sph
