// A mutex that a thread which takes it again and again cannot keep from others: who waits for it holds the
// way in, so that whoever held it last comes after. A std::mutex goes to the thread that is awake, which
// between two steps of a session is the one that steps.
#pragma once
#include <mutex>

namespace truestep {

class FairMutex {
 public:
  void lock() {
    const std::lock_guard way_in(way_in_);
    mutex_.lock();
  }
  /// False also while somebody waits.
  bool try_lock() {
    const std::unique_lock way_in(way_in_, std::try_to_lock);
    return way_in && mutex_.try_lock();
  }
  void unlock() { mutex_.unlock(); }

 private:
  std::mutex way_in_, mutex_;
};

}  // namespace truestep
