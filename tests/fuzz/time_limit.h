// Some inputs describe work that legitimately takes long. It is interrupted, which tests interruption, too.
#pragma once
#include <atomic>
#include <chrono>
#include <thread>

#include "engine/base/interrupt.h"

namespace truestep {

/// During its lifetime, work of this thread is interrupted after a second.
class TimeLimit {
 public:
  TimeLimit() : scope_(clock().interrupt) {
    clock().interrupt.clear();
    clock().ticks_left = kTicks;
  }
  ~TimeLimit() { clock().ticks_left = 0; }

 private:
  static constexpr int kTicks = 10;
  struct Clock {
    Interrupt interrupt;
    std::atomic<int> ticks_left{0};
    Clock() {
      std::thread([this] {
        while (true) {
          std::this_thread::sleep_for(std::chrono::milliseconds(100));
          int left = ticks_left;
          if (left > 0 && ticks_left.compare_exchange_strong(left, left - 1) && left == 1) interrupt.raise();
        }
      }).detach();
    }
  };
  static Clock& clock() {
    static Clock& c = *new Clock;  // outlives its thread
    return c;
  }
  InterruptScope scope_;
};

}  // namespace truestep
