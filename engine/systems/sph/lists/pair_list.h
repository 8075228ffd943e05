// Neighbour lists as the passes read them: each entry a slot and the gradient of the kernel there times a
// particle's volume, in groups of as many entries as Wide has lanes. Passes are bound by memory, so entries
// are small: slots are stored as 16-bit offsets from the first of their group (for floats twice that, which
// the scaled index of a load turns into the place of a number or of a row), and float gradients as 16-bit
// multiples of a unit, the steepest gradient over 32,700. Rounding is an odd function, so two neighbours have
// exactly opposite gradients and momentum is conserved; a list's sums (density's gradient, stiffness) use the
// rounded ones. A partial group is padded with its first slot and gradients of 0.
#pragma once
#include <algorithm>
#include <type_traits>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/kernels/sph/gather.h"
#include "engine/kernels/sph/lanes.h"
#include "engine/kernels/sph/wide/sum_loops.h"

namespace truestep::sph {

template <class T>
using Aligned = std::vector<T, CacheLineAllocator<T>>;

/// Number of particles that share a part of the lists.
inline constexpr size_t kChunk = 256;

/// Whether gradients are rounded, and to how many steps from 0 to the kernel's steepest.
template <class T>
inline constexpr bool kRounded = sizeof(T) == 4;
inline constexpr double kGradientSteps = 32'700;

/// The largest offset of a slot from the first of its group.
inline constexpr size_t kMostAbove = 0x7fff;

/// As many entries as Wide has lanes, in one run of memory that a pass reads from end to end. An entry is a
/// row of four numbers: the gradient in the fluid's `unit` (1/m), volume times that of W, and for floats the
/// slot as twice its offset from the first entry's. Sums over neighbours then need no transposing.
template <class T>
struct Group {
  static constexpr size_t kLanes = Wide<T>::kLanes;
  T g[kLanes][4];
  uint16_t slots[kLanes];  ///< offsets from the first entry's

  size_t above(size_t lane) const { return slots[lane]; }
  /// The row of `Width` numbers of an entry's slot; that of the first entry is at `rows`.
  template <size_t Width>
  const T* place(const T* rows, size_t lane) const {
    return rows + Width * size_t{slots[lane]};
  }
  /// Stores gradients, the first three numbers of each row, and slots relative to the first one.
  void set(const Wide<T> gradient[3], const typename Wide<T>::Mask& over) {
    store_rows3(g, gradient);
    for (size_t k = 0; k < kLanes; ++k) slots[k] = static_cast<uint16_t>(over[k]), g[k][3] = 0;
  }
  /// Lanes without a neighbour. A neighbour is in a list only once: a repeat of the first is padding.
  typename Wide<T>::Mask padding() const {
    typename Wide<T>::Mask out;
    for (size_t k = 0; k < kLanes; ++k) out[k] = k > 0 && slots[k] == 0 ? -1 : 0;
    return out;
  }
};
template <>
struct Group<float> {
  int16_t g[8][4];

  size_t above(size_t lane) const { return size_t{static_cast<uint16_t>(g[lane][3])} / 2; }
  template <size_t Width>
  [[gnu::always_inline]] const float* place(const float* rows, size_t lane) const {
    static_assert(2 * sizeof(float) == 8);
    return reinterpret_cast<const float*>(reinterpret_cast<const char*>(rows) +
                                          Width * 2 * size_t{static_cast<uint16_t>(g[lane][3])});
  }
  void set(const Wide<float> gradient[3], const Wide<float>::Mask& over) {
    store_rows4(g, gradient, over + over);
  }
  Wide<float>::Mask padding() const {
    return (load_last(g) == 0) & (Wide<float>::Mask{0, 1, 2, 3, 4, 5, 6, 7} > 0);
  }
};
/// An index for loads by a group's slots, from entry `first` on.
template <class T>
struct SlotsOf {
  const Group<T>& group;
  size_t first = 0;
  template <size_t Width>
  [[gnu::always_inline]] const T* place(const T* rows, size_t lane) const {
    return group.template place<Width>(rows, first + lane);
  }
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
  uint32_t first[kChunk + 1];
  /// The cells around the current one: positions (m), padded to whole groups with points far from everything,
  /// slots, and rows of both (the fourth number has the slot's bits; the wide-register loops use the rows for
  /// other things). Slot i of the current cell is at i + own.
  Aligned<T> around[3], around_rows;
  Aligned<uint32_t> around_slots;
  Aligned<uint32_t> near;  ///< of the list being made: indices of its neighbours among those around
  size_t around_count = 0, around_seen = 0, own = 0;
  /// Whether slots of those around ascend and none is more than kMostAbove above another.
  bool around_in_order = false;

  /// Addresses of lists, for loops that would otherwise load them again after every store.
  struct Rows {
    Group<T>* groups;
    uint32_t* base;
    T *s, *w, *q;
  };
  Rows rows() { return {groups.data(), base.data(), s.data(), w.data(), q.data()}; }

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
  [[gnu::always_inline]] void rows_of(const Aligned<T>& rows, size_t k, W out[4]) const {
    gather_rows4(rows.data() + 4 * size_t{base[k / kLanes]}, SlotsOf<T>{group(k)}, out);
  }
  /// For the first `count` particles: out[4 k + a] is the sum of gradient times numbers[slot] along axis a
  /// (a = 3 is unused). `wide` are this processor's loops for floats, if it has any.
  void sum_times(const Aligned<T>& numbers, size_t count, const SumLoops* wide, T* out) const {
    if constexpr (kRounded<T>) {
      if (wide) return wide->times(view(), count, numbers.data(), out);
    }
    for (size_t k = 0; k < count; ++k) {
      sum_rows(over(first[k], first[k + 1],
                    [&](size_t from, const SlotsOf<T>& slots) {
                      return numbers_by_fours(numbers.data() + from, slots);
                    }),
               out + 4 * k);
    }
  }
  /// The same of the products of gradients and rows[slot], for rows of four whose last number is 0: out[k].
  void sum_dot(const Aligned<T>& rows, size_t count, const SumLoops* wide, T* out) const {
    if constexpr (kRounded<T>) {
      if (wide) return wide->dot(view(), count, rows.data(), out);
    }
    for (size_t k = 0; k < count; ++k) out[k] = sum_dot(rows, first[k], first[k + 1]);
  }
  /// The same of the entries from `begin` to `end`.
  T sum_dot(const Aligned<T>& rows, size_t begin, size_t end) const {
    return sum(over(begin, end, [&](size_t from, const SlotsOf<T>& slots) {
      return rows_side_by_side(rows.data() + 4 * from, slots);
    }));
  }

  /// Room for `seen` slots around a cell, before any are left out, so that it does not depend on what a step
  /// happens to keep.
  void need_around(size_t seen) {
    around_seen = seen;
    const size_t room = seen + 2 * kLanes;
    if (around_slots.size() >= room) return;
    // Whole cache lines, so that each column of the scratch starts with one.
    const size_t more = (room + room / 2 + 15) / 16 * 16;
    around_slots.resize(more), around_rows.resize(kScratch * more), near.resize(2 * more);
    for (auto& a : around) a.resize(more);
  }
  /// Appends those of slots `begin` to `end`, their positions x moved by `shift` (m), whose squared distance
  /// from the box between `low` and `top` is within `limit`. No point that is so close to a point in the box
  /// is left out: rounding is monotone. `first` is the current cell's first slot if that is among
  /// them.
  template <size_t D>
  [[gnu::always_inline]] void put_around(const Aligned<T>* x, size_t begin, size_t end, size_t first,
                                         const double* shift, const W* low, const W* top, const W& limit) {
    W by[D];
    T* places[D];
    for (size_t a = 0; a < D; ++a) by[a] = W::all(static_cast<T>(shift[a])), places[a] = around[a].data();
    uint32_t* const slots = around_slots.data();
    size_t count = around_count, at = own;
    for (size_t k = begin; k < end; k += kLanes) {
      W place[D], square = W::zero();
      for (size_t a = 0; a < D; ++a) {
        place[a] = load(x[a].data() + k) + by[a];
        const W beyond = max(max(low[a] - place[a], place[a] - top[a]), W::zero());
        square = madd(beyond, beyond, square);
      }
      uint32_t bits = bits_below(square, limit);
      if (end - k < kLanes) bits &= (1u << (end - k)) - 1;
      // The cell's own particles are in the box and all kept, so slots from `first` on stay consecutive.
      if (first - k < kLanes) {
        at = count - first + static_cast<size_t>(__builtin_popcount(bits & ((1u << (first - k)) - 1)));
      }
      const LanesOf<T> lanes(bits);
      for (size_t a = 0; a < D; ++a) lanes.store(places[a] + count, place[a]);
      count += store_lanes<kLanes>(slots + count, static_cast<uint32_t>(k), bits);
    }
    around_count = count, own = at;
  }
  /// Pads the candidates to a whole group and copies them into rows.
  template <size_t D>
  void end_around() {
    const size_t end = (around_count + kLanes - 1) / kLanes * kLanes;
    for (size_t k = around_count; k < end; ++k) {
      for (auto& a : around) a[k] = kFar;
    }
    for (size_t k = 0; k < end; k += kLanes) {
      W columns[4] = {W::zero(), W::zero(), W::zero(), {}};
      for (size_t a = 0; a < D; ++a) columns[a] = load(around[a].data() + k);
      columns[3].v = __builtin_bit_cast(typename W::Raw, whole<T>(around_slots.data() + k));
      put_rows4(around_rows.data() + 4 * k, columns);
    }
    around_count = end;
  }

  /// Positions of the neighbours in `near`, from `at` of `count`, that fit into one group: with slots in
  /// order one per lane, otherwise it ends before a slot that is below its first one or too far above it.
  struct Taken {
    size_t count;                    ///< of neighbours
    uint32_t base;                   ///< slot of the first
    typename W::Mask inside, above;  ///< lanes that have one; slots over the first one, else 0
  };
  template <bool InOrder>
  [[gnu::always_inline]] Taken take(size_t at, size_t count, W there[4]) const {
    using Mask = typename W::Mask;
    gather_rows4(around_rows.data(), near.data() + at, there);
    const Mask slots = __builtin_bit_cast(Mask, there[3].v), above = slots - slots[0];
    size_t full = std::min(count - at, kLanes);
    if constexpr (!InOrder) {
      const uint32_t apart = ~lanes_set<T>((above >= 0) & (above <= int{kMostAbove})) & ((1u << full) - 1);
      // A branch, so that the next group does not wait for this one's slots.
      if (apart != 0) [[unlikely]] {
        full = static_cast<size_t>(__builtin_ctz(apart));
      }
    }
    const Mask inside = first_lanes<T>(full);
    return {full, static_cast<uint32_t>(slots[0]), inside, above & inside};
  }

  /// Room for `entries` and as many of slopes, weights, distances as `extras` says.
  void need(size_t entries, size_t extras) {
    const size_t least = entries + 2 * kLanes;
    if (kLanes * groups.size() >= least) return;
    const size_t room = (least + least / 2) / kLanes * kLanes;
    groups.resize(room / kLanes), base.resize(room / kLanes);
    if (extras > 0) s.resize(room);
    if (extras > 1) w.resize(room);
    if (extras > 2) q.resize(room);
  }

  /// The lists as the wide-register loops take them.
  ListView view() const { return {groups[0].g[0], base.data(), first}; }

 private:
  static constexpr T kFar = T(1e18);                       ///< m
  static constexpr size_t kScratch = kRounded<T> ? 8 : 4;  ///< columns, two lists' for wider registers
  /// Sums of entries times factor(slot of the first, offsets): four partial sums, so that no multiply-add
  /// waits for the one before.
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
};

}  // namespace truestep::sph
