// Particles between the rows of a state and groups of lanes, four numbers of a row at a time.
#pragma once
#include <cstring>

#include "engine/core/state.h"
#include "engine/systems/mpm/blocks.h"
#include "engine/systems/mpm/solver.h"
#include "engine/systems/mpm/transfer.h"

namespace truestep::mpm {

template <int D, class T>
class Rows {
 public:
  explicit Rows(State& s)
      : x_(s.span<T>(columns::position).data()),
        v_(s.span<T>(columns::velocity).data()),
        c_(s.span<T>(columns::affine).data()),
        f_(s.span<T>(columns::deformation).data()),
        plastic_(s.span<T>(columns::plastic).data()),
        j_(s.span<T>(columns::jacobian).data()),
        count_(s.rows(columns::position)) {}

  size_t count() const { return count_; }
  const T* place(size_t row) const { return x_ + 3 * row; }

  /// Fills groups; lanes without a particle get the one before them.
  void load(Sorted<D, T>& to, const ThreadArena& arena) const {
    arena.for_blocks(to.slots(), kBlockRows, [&](size_t begin, size_t end) {
      for (size_t s = begin; s < end; s += kLanes) {
        uint32_t row[kLanes];
        for (size_t lane = 0; lane < kLanes; ++lane) {
          row[lane] = to.row[s + lane];
          if (row[lane] == Sorted<D, T>::kNone) row[lane] = row[lane - 1];
        }
        T* group = to.group(s);
        load_vector(x_, row, group + L::x * kLanes);
        load_vector(v_, row, group + L::v * kLanes);
        load_square(c_, row, group + L::c * kLanes);
        load_square(f_, row, group + L::f * kLanes);
        for (size_t lane = 0; lane < kLanes; ++lane) {
          group[L::plastic * kLanes + lane] = plastic_[row[lane]];
          group[L::jacobian * kLanes + lane] = j_[row[lane]];
        }
      }
    });
  }
  void save(const Sorted<D, T>& from, const ThreadArena& arena) const {
    arena.for_blocks(from.slots(), kBlockRows, [&](size_t begin, size_t end) {
      for (size_t s = begin; s < end; s += kLanes) {
        size_t many = 0;
        const uint32_t* row = from.row.data() + s;
        while (many < kLanes && row[many] != Sorted<D, T>::kNone) ++many;
        const T* group = from.group(s);
        save_columns<D>(group + L::x * kLanes, x_, 3, row, many);
        save_columns<D>(group + L::v * kLanes, v_, 3, row, many);
        save_columns<D * D>(group + L::c * kLanes, c_, D * D, row, many);
        save_columns<D * D>(group + L::f * kLanes, f_, D * D, row, many);
        for (size_t lane = 0; lane < many; ++lane) {
          plastic_[row[lane]] = group[L::plastic * kLanes + lane];
          j_[row[lane]] = group[L::jacobian * kLanes + lane];
        }
      }
    });
  }

 private:
  using L = Layout<D>;
  using W = Wide<T>;
  static constexpr size_t kLanes = W::kLanes;

  /// Numbers of a row from `in` on, of which there are at least four behind every one, go to lanes.
  template <int Many>
  static void spread(const T* rows, T* group) {
    W four[4];
    from_rows(rows, four);
    for (int k = 0; k < Many; ++k) store(group + static_cast<size_t>(k) * kLanes, four[k]);
  }
  void load_vector(const T* in, const uint32_t* row, T* group) const {
    alignas(64) T rows[4 * kLanes];
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const T* from = in + 3 * size_t{row[lane]};
      // A fourth number that nobody looks at, where there is one.
      if (row[lane] + size_t{1} < count_) {
        std::memcpy(rows + 4 * lane, from, 4 * sizeof(T));
      } else {
        for (size_t k = 0; k < 4; ++k) rows[4 * lane + k] = k < 3 ? from[k] : T{0};
      }
    }
    spread<D>(rows, group);
  }
  void load_square(const T* in, const uint32_t* row, T* group) const {
    alignas(64) T rows[4 * kLanes];
    constexpr size_t kWidth = D * D, kWhole = kWidth / 4 * 4;
    for (size_t first = 0; first < kWhole; first += 4) {
      for (size_t lane = 0; lane < kLanes; ++lane)
        std::memcpy(rows + 4 * lane, in + kWidth * row[lane] + first, 4 * sizeof(T));
      spread<4>(rows, group + first * kLanes);
    }
    for (size_t k = kWhole; k < kWidth; ++k) {
      for (size_t lane = 0; lane < kLanes; ++lane) group[k * kLanes + lane] = in[kWidth * row[lane] + k];
    }
  }
  /// `Many` numbers of the first `many` lanes to rows of `width`.
  template <size_t Many>
  static void save_columns(const T* group, T* out, size_t width, const uint32_t* row, size_t many) {
    alignas(64) T rows[4 * kLanes];
    for (size_t first = 0; first < Many; first += 4) {
      W four[4];
      const size_t here = std::min<size_t>(4, Many - first);
      for (size_t k = 0; k < 4; ++k)
        four[k] = k < here ? truestep::mpm::load(group + (first + k) * kLanes) : W::zero();
      to_rows(four, rows);
      for (size_t lane = 0; lane < many; ++lane)
        std::memcpy(out + width * row[lane] + first, rows + 4 * lane, here * sizeof(T));
    }
  }

  T *x_, *v_, *c_, *f_, *plastic_, *j_;
  size_t count_;
};

}  // namespace truestep::mpm
