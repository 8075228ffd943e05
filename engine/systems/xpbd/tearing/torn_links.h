// Links of a tearing cloth once one of their ends has been split: strands, each solved by itself
// (tear_surface.h). The schedule has room for all of them; batches without a strand are skipped.
#pragma once
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/core/system.h"
#include "engine/kernels/xpbd/chain.h"
#include "engine/systems/xpbd/schedule.h"
#include "engine/systems/xpbd/tearing/tear_surface.h"

namespace truestep::xpbd {

template <class T>
class TornLinks {
 public:
  struct Stiffness {
    std::span<const double> families;
    double damping = 0;  ///< N s/m
    bool soft = true, keeps = false;
  };
  void pack(const TearSurface& tears, const Body& body, const Schedule& schedule, const State& state,
            const Stiffness& stiffness);
  void load(const double* x);
  void forget_multipliers() { std::fill(lambda_.begin(), lambda_.end(), T(0)); }
  /// Returns the largest q.
  T solve(const PerStep<T>& per, const T* before, T relax, T* rows, const ThreadArena& arena);

 private:
  static constexpr auto kLanes = static_cast<size_t>(Wide<T>::kLanes);
  template <class U>
  using Column = std::vector<U, CacheLineAllocator<U>>;
  bool damped_ = false;
  std::vector<uint32_t> points_;  // 2 x lanes a batch
  Column<T> rest_, compliance_, damping_, lambda_, base_;
  std::vector<uint32_t> active_;  // batches
  std::vector<Colour> colours_;   // of active_
  std::vector<uint8_t> used_;     // per entry
  std::vector<T> q_;
};

extern template class TornLinks<float>;
extern template class TornLinks<double>;

}  // namespace truestep::xpbd
