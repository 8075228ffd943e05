// Threads for one kind of work. Turns with the least time used so far run first, so that small requests are
// served soon and nobody starves.
#pragma once
#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

namespace truestep {

class Lane {
 public:
  /// `niceness` as in nice(1): threads that compute for long yield to those that answer requests.
  Lane(int threads, int niceness);
  ~Lane();
  Lane(const Lane&) = delete;
  Lane& operator=(const Lane&) = delete;

  /// Runs `turn` once. `used` is the (weighted) time in s that its owner has had so far; a newcomer starts at
  /// the smallest value among those waiting, which is written to `used`. Returns false and does nothing after
  /// stop().
  bool add(double& used, std::function<void()> turn);
  /// Runs the queued turns, which see that the service is stopping, and joins the threads.
  void stop();

 private:
  void work(int niceness);
  std::mutex mutex_;
  std::condition_variable wake_;
  std::multimap<double, std::function<void()>> waiting_;
  double floor_ = 0;  ///< `used` of the turn that ran last
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

/// Lowers this thread's priority so that it runs only on cores nobody else needs.
void yield_to_others(int niceness);

}  // namespace truestep
