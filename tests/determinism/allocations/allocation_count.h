// How often memory is asked for: allocation_count.cc puts a counting operator new in place of the usual one.
#pragma once
#include <cstdint>
#include <memory>
#include <utility>

#include "engine/core/system.h"

namespace truestep::test {

/// Calls of operator new so far, by any thread.
uint64_t allocations();

/// How many of them `work` makes.
template <class Work>
uint64_t allocations_of(Work&& work) {
  const uint64_t before = allocations();
  std::forward<Work>(work)();
  return allocations() - before;
}

/// A system stepped without a session around it.
class CountedSteps {
 public:
  CountedSteps(std::unique_ptr<const System> system, double h)
      : system_(std::move(system)), h_(h), state_(system_->initial_state()) {}

  /// Makes n steps and returns how often they allocate.
  uint64_t steps(uint64_t n) {
    return allocations_of([&] {
      for (uint64_t k = 0; k < n; ++k, ++done_) {
        system_->step(
            state_,
            {.t = double(done_) * h_, .h = h_, .step = done_, .workspace = workspace_, .arena = arena_});
      }
    });
  }
  const State& state() const { return state_; }

 private:
  std::unique_ptr<const System> system_;
  double h_;
  State state_;
  Workspace workspace_;
  ThreadArena arena_{1};
  uint64_t done_ = 0;
};

}  // namespace truestep::test
