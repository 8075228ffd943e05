// A floating-point column of a state, f32 or f64, read and written as doubles, for code that reaches into
// states of unknown systems.
#pragma once
#include <type_traits>

#include "engine/core/state/state.h"
#include "engine/math/quaternion.h"

namespace truestep {

/// Real is double or const double; empty when no column was given. Valid until rows change.
template <class Real>
class RealColumn {
 public:
  using StateRef = std::conditional_t<std::is_const_v<Real>, const State&, State&>;
  using Single = std::conditional_t<std::is_const_v<Real>, const float, float>;

  RealColumn() = default;
  RealColumn(StateRef s, State::Column c) {
    if (s.info(c).type == Scalar::f32) {
      singles_ = s.template span<float>(c).data();
    } else {
      doubles_ = s.f64(c).data();
    }
  }
  explicit operator bool() const { return doubles_ || singles_; }
  /// Null where the column is f32.
  Real* doubles() const { return doubles_; }

  double at(size_t k) const { return doubles_ ? doubles_[k] : double{singles_[k]}; }
  void set(size_t k, double to) {
    if (doubles_) {
      doubles_[k] = to;
    } else {
      singles_[k] = static_cast<float>(to);
    }
  }
  Vec3 vector(size_t row) const { return {at(3 * row), at(3 * row + 1), at(3 * row + 2)}; }
  void set_vector(size_t row, const Vec3& to) {
    set(3 * row, to.x), set(3 * row + 1, to.y), set(3 * row + 2, to.z);
  }
  Quat quaternion(size_t row) const {
    return {at(4 * row), at(4 * row + 1), at(4 * row + 2), at(4 * row + 3)};
  }
  void set_quaternion(size_t row, const Quat& to) {
    set(4 * row, to.w), set(4 * row + 1, to.x), set(4 * row + 2, to.y), set(4 * row + 3, to.z);
  }

 private:
  Real* doubles_ = nullptr;
  Single* singles_ = nullptr;
};

}  // namespace truestep
