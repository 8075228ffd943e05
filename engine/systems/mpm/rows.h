// Copies particles between the rows of a state and groups of lanes.
#pragma once
#include "engine/core/state/state.h"
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

  /// Fills groups; lanes without a particle repeat the one before them.
  void load(Sorted<D, T>& to, const ThreadArena& arena) const {
    arena.for_blocks(to.slots(), kBlockRows, [&](size_t begin, size_t end) {
      for (size_t s = begin; s < end; s += kLanes) {
        uint32_t row[kLanes];
        uint32_t last = to.row[s];
        for (size_t lane = 0; lane < kLanes; ++lane) {
          if (to.row[s + lane] != Sorted<D, T>::kNone) last = to.row[s + lane];
          row[lane] = last;
        }
        T* group = to.group(s);
        if constexpr (D == 2) {
          load_squares(c_, row, group + L::c * kLanes);
          load_squares(f_, row, group + L::f * kLanes);
        }
        for (size_t lane = 0; lane < kLanes; ++lane) {
          const size_t i = row[lane];
          T* at = group + lane;
          for (size_t k = 0; k < D; ++k) {
            at[(L::x + k) * kLanes] = x_[3 * i + k], at[(L::v + k) * kLanes] = v_[3 * i + k];
          }
          for (size_t k = 0; D == 3 && k < D * D; ++k) {
            at[(L::c + k) * kLanes] = c_[D * D * i + k], at[(L::f + k) * kLanes] = f_[D * D * i + k];
          }
          at[L::plastic * kLanes] = plastic_[i], at[L::jacobian * kLanes] = j_[i];
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
        if constexpr (D == 2) {
          save_squares(group + L::c * kLanes, c_, row, many);
          save_squares(group + L::f * kLanes, f_, row, many);
        }
        for (size_t lane = 0; lane < many; ++lane) {
          const size_t i = row[lane];
          const T* at = group + lane;
          for (size_t k = 0; k < D; ++k) {
            x_[3 * i + k] = at[(L::x + k) * kLanes], v_[3 * i + k] = at[(L::v + k) * kLanes];
          }
          for (size_t k = 0; D == 3 && k < D * D; ++k) {
            c_[D * D * i + k] = at[(L::c + k) * kLanes], f_[D * D * i + k] = at[(L::f + k) * kLanes];
          }
          plastic_[i] = at[L::plastic * kLanes], j_[i] = at[L::jacobian * kLanes];
        }
      }
    });
  }

 private:
  using L = Layout<D>;
  using W = Wide<T>;
  static constexpr size_t kLanes = W::kLanes;

  // Matrices of the plane are four consecutive numbers of a row and are transposed as a whole. (In space,
  // where nine numbers do not fit evenly, that was slower by an eighth.)
  static void load_squares(const T* in, const uint32_t* row, T* group) {
    W four[4];
    gather_rows4(in, row, four);
    for (size_t k = 0; k < 4; ++k) truestep::mpm::store(group + k * kLanes, four[k]);
  }
  static void save_squares(const T* group, T* out, const uint32_t* row, size_t many) {
    W four[4];
    for (size_t k = 0; k < 4; ++k) four[k] = truestep::mpm::load(group + k * kLanes);
    if (many == kLanes) return scatter_rows4(out, row, four);
    for (size_t lane = 0; lane < many; ++lane) {
      for (size_t k = 0; k < 4; ++k) out[4 * size_t{row[lane]} + k] = group[k * kLanes + lane];
    }
  }

  T *x_, *v_, *c_, *f_, *plastic_, *j_;
  size_t count_;
};

}  // namespace truestep::mpm
