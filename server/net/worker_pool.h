// Threads that run what is posted, in the order of the posts: Boost.Asio's thread pool without its headers.
#pragma once
#include <memory>

#include "server/tasks/executor.h"

namespace truestep::net {

class WorkerPool final : public Executor {
 public:
  explicit WorkerPool(int threads);
  /// Leaves out what has not begun.
  ~WorkerPool() override;
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  void post(std::function<void()> f) override;
  TimerPtr call_at(std::chrono::steady_clock::time_point when,
                   std::function<void(const TimerPtr&)> f) override;
  /// Runs what has been posted and joins the threads; what is posted later is not run.
  void join();

 private:
  friend class Strand;
  struct Threads;
  std::unique_ptr<Threads> threads_;
};

/// Calls on a pool that run one after the other.
class Strand {
 public:
  explicit Strand(WorkerPool& pool);
  ~Strand();
  void post(std::function<void()> f);

 private:
  struct Queue;
  std::unique_ptr<Queue> queue_;
};

}  // namespace truestep::net
