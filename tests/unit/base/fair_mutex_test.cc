// A thread waiting for a session's lock gets it after the step in progress, however soon the next one
// follows.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <thread>

#include "server/sessions/fair_mutex.h"

namespace truestep {
namespace {

constexpr int kEnough = 100;

// How often a thread that relocks the mutex at once got it between another thread's request and its turn, in
// 21 trials, ascending: either thread may be descheduled at any moment. After a hundred times it gives up.
template <class Mutex>
std::array<int, 21> turns_waited() {
  Mutex mutex;
  std::atomic<bool> over = false;
  std::atomic<int> turns = 0;
  std::thread greedy([&] {
    while (!over) {
      if (turns >= kEnough) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      const std::lock_guard lock(mutex);
      ++turns;
      const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(1);
      while (std::chrono::steady_clock::now() < end) continue;
    }
  });
  std::array<int, 21> waited{};
  for (int& w : waited) {
    while (turns == 0) std::this_thread::yield();
    const int before = turns;
    const std::lock_guard lock(mutex);
    w = turns - before;
    turns = 0;
  }
  over = true;
  greedy.join();
  std::sort(waited.begin(), waited.end());
  return waited;
}

/// The control: a mutex that goes to whichever thread is awake, as a std::mutex may.
class BargingMutex {
 public:
  void lock() {
    while (!mutex_.try_lock()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  void unlock() { mutex_.unlock(); }

 private:
  std::mutex mutex_;
};

TEST(FairMutex, GoesToWhoWaits) {
  EXPECT_LE(turns_waited<FairMutex>()[10], 2);
  EXPECT_GT(turns_waited<BargingMutex>()[20], 10);
}

TEST(FairMutex, IsTriedWithoutWaiting) {
  FairMutex mutex;
  EXPECT_TRUE(mutex.try_lock());
  std::thread([&] { EXPECT_FALSE(mutex.try_lock()); }).join();
  mutex.unlock();
  EXPECT_TRUE(mutex.try_lock());
  mutex.unlock();
}

}  // namespace
}  // namespace truestep
