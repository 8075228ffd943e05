// Lists of neighbours as the passes read them: for each entry a slot and the gradient of the kernel there
// times a particle's volume, in groups of as many entries as Wide has lanes. Passes are bound by memory, so
// that what they read is small: slots are 16 bits above the first one of their group, and gradients of floats
// are 16-bit multiples of a unit, the steepest gradient over 32,700. Rounding is odd, so that two neighbours
// have opposite gradients to the bit and momentum is kept; what a list sums up (density's gradient,
// stiffness) is made of the rounded ones. A group that is not full is filled up with its first slot and
// gradients of 0.
#pragma once
#include <algorithm>
#include <type_traits>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/kernels/sph/gather.h"

namespace truestep::sph {

template <class T>
using Aligned = std::vector<T, CacheLineAllocator<T>>;

/// Particles that share a part of the lists.
inline constexpr size_t kChunk = 256;

/// Whether gradients are rounded, and to how many steps from 0 to the steepest of their kernel.
template <class T>
inline constexpr bool kRounded = sizeof(T) == 4;
inline constexpr double kGradientSteps = 32'700;

/// As many entries as Wide has lanes: one run of memory that a pass reads from end to end.
template <class T>
struct Group {
  static constexpr size_t kLanes = Wide<T>::kLanes;
  using Gradient = std::conditional_t<kRounded<T>, int16_t, T>;
  Gradient g[3][kLanes];   ///< in the fluid's `unit` (1/m): volume times the gradient of W
  uint16_t above[kLanes];  ///< slot over that of the first entry
  uint32_t base;           ///< slot of the first entry
};

/// Lists of the neighbours of kChunk particles. Entries are counted from 0 on; k is the first one of a group.
template <class T>
struct Chunk {
  using W = Wide<T>;
  static constexpr size_t kLanes = W::kLanes;

  std::vector<Group<T>> groups;
  Aligned<T> s;  ///< 1/m^2, volume times dW/dr / r
  Aligned<T> w;  ///< 1, volume times W
  Aligned<T> q;  ///< 1, distance over the kernel's radius
  /// Of the one list that is being made: slots, offsets (m) and squared distances (m^2).
  std::vector<uint32_t> near;
  Aligned<T> away[3], square;
  uint32_t first[kChunk + 1];

  Group<T>& group(size_t k) { return groups[k / kLanes]; }
  const Group<T>& group(size_t k) const { return groups[k / kLanes]; }
  /// Gradients along axis a, in units.
  W gradient(size_t a, size_t k) const { return load_as<T>(group(k).g[a]); }
  /// numbers[slot].
  W of(const Aligned<T>& numbers, size_t k) const {
    return gather(numbers.data() + group(k).base, group(k).above);
  }
  /// out[c]: number c of rows[slot], rows of four.
  void rows_of(const Aligned<T>& rows, size_t k, W out[4]) const {
    gather_rows4(rows.data() + 4 * size_t{group(k).base}, group(k).above, out);
  }

  /// Puts the list that `near` and the rest hold, of the entries from `begin` to `end`, into groups; returns
  /// the new end, of whole groups. What fills them up is `far` away (m^2).
  size_t pack(size_t begin, size_t end, T far, size_t extras) {
    for (size_t k = begin; k < end; k += kLanes) {
      const size_t at = k - begin;
      Group<T>& out = groups[k / kLanes];
      out.base = near[at];
      size_t full = 1;
      // A slot below the first wraps around and is too far above, too.
      for (; full < kLanes && k + full < end && near[at + full] - out.base <= 0xffff; ++full) {
        out.above[full] = static_cast<uint16_t>(near[at + full] - out.base);
      }
      out.above[0] = 0;
      if (full == kLanes) continue;
      if (k + full < end) {
        need(begin, end, kLanes, extras);
        shift(at + full, end - begin, kLanes - full);
      }
      end += kLanes - full;
      Group<T>& filled = groups[k / kLanes];
      for (size_t lane = full; lane < kLanes; ++lane) {
        filled.above[lane] = 0, near[at + lane] = filled.base, square[at + lane] = far;
        for (auto& a : away) a[at + lane] = 0;
      }
    }
    return end;
  }

  /// Room for `more` entries behind `used` of which those from `begin` on are one list, with gradients and
  /// as many of slopes and weights, distances as `extras` says.
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
    groups.resize(room / kLanes);
    if (extras > 0) s.resize(room), w.resize(room);
    if (extras > 1) q.resize(room);
  }

 private:
  /// Moves what the list has from `from` to `end` on by `by`.
  void shift(size_t from, size_t end, size_t by) {
    const auto move = [&](auto& a) { std::copy_backward(&a[from], &a[0] + end, &a[0] + end + by); };
    move(near), move(square);
    for (auto& a : away) move(a);
  }
};

}  // namespace truestep::sph
