// A fair mutex: a thread that relocks it in a loop cannot starve the others. A waiting thread holds the
// entrance, so the previous owner queues behind it. A std::mutex goes to whichever thread is awake, which
// between two steps of a session is always the one that steps.
#pragma once
#include <mutex>

namespace truestep {

class FairMutex {
 public:
  void lock() {
    const std::lock_guard way_in(way_in_);
    mutex_.lock();
  }
  /// Also false while somebody is waiting.
  bool try_lock() {
    const std::unique_lock way_in(way_in_, std::try_to_lock);
    return way_in && mutex_.try_lock();
  }
  void unlock() { mutex_.unlock(); }

 private:
  std::mutex way_in_, mutex_;
};

}  // namespace truestep
