// Work that can be told to stop. The caller of long work puts an Interrupt in scope of its thread; the work
// passes interruption points (between substeps, loops over rows, iterations), which throw once it is raised.
// The partial result is then worthless; the input is untouched.
#pragma once
#include <atomic>
#include <cstdint>

#include "engine/base/errors.h"

namespace truestep {

/// Raised from any thread, checked by the working thread.
class Interrupt {
 public:
  void raise() { raised_.store(true, std::memory_order_relaxed); }
  void clear() { raised_.store(false, std::memory_order_relaxed); }
  bool raised() const { return raised_.load(std::memory_order_relaxed); }
  const std::atomic<bool>& flag() const { return raised_; }

 private:
  std::atomic<bool> raised_{false};
};

/// Thrown by interruption_point; code "cancelled".
class Interrupted : public Error {
 public:
  Interrupted();
  Interrupted(const Interrupted&);
  ~Interrupted() override;
};

namespace interrupt_detail {
inline constinit thread_local const std::atomic<bool>* in_scope = nullptr;
[[noreturn]] void stop();
}  // namespace interrupt_detail

/// While alive, this thread's interruption points obey the flag; scopes nest, the innermost counts. Null:
/// nothing interrupts, for work that must be finished once begun.
class InterruptScope {
 public:
  explicit InterruptScope(const std::atomic<bool>* flag) : outer_(interrupt_detail::in_scope) {
    interrupt_detail::in_scope = flag;
  }
  explicit InterruptScope(const Interrupt& interrupt) : InterruptScope(&interrupt.flag()) {}
  ~InterruptScope() { interrupt_detail::in_scope = outer_; }
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;

 private:
  const std::atomic<bool>* outer_;
};

/// Throws Interrupted when this thread's work has been interrupted; otherwise costs a few nanoseconds.
inline void interruption_point() {
  const std::atomic<bool>* flag = interrupt_detail::in_scope;
  if (flag && flag->load(std::memory_order_relaxed)) interrupt_detail::stop();
}

}  // namespace truestep
