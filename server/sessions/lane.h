// Threads for one kind of work, which take turns: what has used least time so far goes first, so that whoever
// wants little is served soon and nobody waits for ever.
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
  /// `niceness` as of nice(1): threads that compute for long leave the cores to those that answer.
  Lane(int threads, int niceness);
  ~Lane();
  Lane(const Lane&) = delete;
  Lane& operator=(const Lane&) = delete;

  /// Runs `turn` once. `used` are the (weighted) seconds that its owner has had; a newcomer starts with what
  /// the least of those waiting has had, which `used` becomes. False, and nothing done, after stop().
  bool add(double& used, std::function<void()> turn);
  /// Runs what waits, which knows that the end has come, and joins the threads.
  void stop();

 private:
  void work(int niceness);
  std::mutex mutex_;
  std::condition_variable wake_;
  std::multimap<double, std::function<void()>> waiting_;
  double floor_ = 0;  ///< what the last turn counted as
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

/// Lets this thread run only when others do not need its core.
void yield_to_others(int niceness);

}  // namespace truestep
