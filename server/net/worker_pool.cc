#include "server/net/worker_pool.h"

#include <boost/asio/post.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/thread_pool.hpp>

#include "server/net/timer.h"

namespace truestep::net {

namespace asio = boost::asio;

struct WorkerPool::Threads {
  explicit Threads(int count) : pool(static_cast<size_t>(count)) {}
  asio::thread_pool pool;
};

struct Strand::Queue {
  asio::strand<asio::thread_pool::executor_type> strand;
};

WorkerPool::WorkerPool(int threads) : threads_(std::make_unique<Threads>(threads)) {}
WorkerPool::~WorkerPool() = default;

void WorkerPool::post(std::function<void()> f) {
  asio::post(threads_->pool, std::move(f));
}

TimerPtr WorkerPool::call_at(std::chrono::steady_clock::time_point when,
                             std::function<void(const TimerPtr&)> f) {
  return start_timer(threads_->pool.get_executor(), when, std::move(f));
}

void WorkerPool::join() {
  threads_->pool.join();
}

Strand::Strand(WorkerPool& pool)
    : queue_(std::make_unique<Queue>(Queue{asio::make_strand(pool.threads_->pool)})) {}
Strand::~Strand() = default;

void Strand::post(std::function<void()> f) {
  asio::post(queue_->strand, std::move(f));
}

}  // namespace truestep::net
