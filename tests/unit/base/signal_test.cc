// What handlers wait for (server/tasks): signals, work on other threads, and being given up.
#include "server/tasks/signal.h"

#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include "server/net/event_loop.h"
#include "server/net/worker_pool.h"
#include "server/tasks/offload.h"

namespace truestep {
namespace {

using namespace std::chrono_literals;

// A task on an event loop of its own.
class Running {
 public:
  explicit Running(Task<> task) {
    root_.emplace(std::move(task), context_, [this](const std::exception_ptr& e) {
      ended_ = true;
      error_ = e;
    });
    root_->start();
  }
  void finish() {
    while (!ended_ && loop_.io().run_one() > 0) {
    }
    if (error_) std::rethrow_exception(error_);
  }
  void poll() { loop_.io().poll(); }
  void cancel() { context_.cancel(); }
  bool ended() const { return ended_; }

 private:
  net::EventLoop loop_;
  // Work elsewhere is none of the loop's.
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> busy_{loop_.io().get_executor()};
  TaskContext context_{loop_};
  bool ended_ = false;
  std::exception_ptr error_;
  std::optional<RootTask> root_;
};

auto in(std::chrono::steady_clock::duration time) {
  return std::chrono::steady_clock::now() + time;
}

Task<> wait_an_hour(Signal& signal) {
  co_await signal.wait(0, in(1h));
}

TEST(Signal, WhoWaitsLeavesWhenItsContextEnds) {
  Signal signal;
  {
    Running running(wait_an_hour(signal));
    running.poll();
    EXPECT_EQ(signal.waiting(), 1u) << "control: it waits";
  }
  // A former bug: its timer stayed here, and was destroyed after the context that it belongs to.
  EXPECT_EQ(signal.waiting(), 0u);
}

TEST(Signal, WhoIsWokenLeaves) {
  Signal signal;
  Running running(wait_an_hour(signal));
  running.poll();
  signal.notify();
  running.finish();
  EXPECT_EQ(signal.waiting(), 0u);
}

Task<> wait_and_see(Signal& signal, std::chrono::milliseconds time, std::string& seen) {
  const bool raised = co_await signal.wait(signal.version(), in(time));
  seen += raised ? "raised " : "over ";
}

TEST(Signal, TellsATimeOutFromARaise) {
  Signal signal;
  std::string seen;
  Running(wait_and_see(signal, 5ms, seen)).finish();
  Running running(wait_and_see(signal, 1h, seen));
  std::thread other([&] { signal.notify(); });
  running.finish();
  other.join();
  EXPECT_EQ(seen, "over raised ");
}

Task<> wait_twice(Signal& signal, std::string& seen) {
  co_await wait_and_see(signal, std::chrono::milliseconds(1h), seen);
  co_await wait_and_see(signal, std::chrono::milliseconds(1h), seen);
}

TEST(Task, ThatIsGivenUpEndsItsWaitAndThrowsAtTheNext) {
  Signal signal;
  std::string seen;
  Running running(wait_twice(signal, seen));
  running.poll();
  running.cancel();
  EXPECT_THROW(running.finish(), Cancelled);
  EXPECT_EQ(seen, "over ");
  EXPECT_EQ(signal.waiting(), 0u);
}

Task<> wait_for_work(Signal& signal, std::string& seen) {
  bool over = false;
  const auto ended = [&] { return over; };
  const auto give_up = [&] {
    seen += "given up ";
    over = true;
    signal.notify();
  };
  co_await wait_for_end(signal, ended, give_up);
  co_await wait_and_see(signal, 1ms, seen);
}

TEST(Task, ThatWaitsForWorkElsewhereTellsItAndWaitsOn) {
  Signal signal;
  std::string seen;
  Running running(wait_for_work(signal, seen));
  running.poll();
  EXPECT_FALSE(running.ended());
  running.cancel();
  running.finish();
  EXPECT_EQ(seen, "given up over ");
}

Task<int> twice(net::WorkerPool& pool, int n) {
  const auto caller = std::this_thread::get_id();
  auto work = [n, caller] {
    if (n < 0) throw std::runtime_error("negative");
    return std::this_thread::get_id() == caller ? 0 : 2 * n;
  };
  const int result = co_await offload(pool, std::move(work));
  co_return std::this_thread::get_id() == caller ? result : -1;
}

Task<> sum_of(net::WorkerPool& pool, int& sum) {
  for (int i = 0; i < 10; ++i) {
    const int part = co_await twice(pool, i);
    sum += part;
  }
  co_await twice(pool, -1);
}

TEST(Task, WorksElsewhereAndComesBackWithResultOrException) {
  net::WorkerPool pool(2);
  int sum = 0;
  Running running(sum_of(pool, sum));
  EXPECT_THROW(running.finish(), std::runtime_error);
  EXPECT_EQ(sum, 90);
}

Task<int> at_once(int i) {
  co_return i;
}

Task<> count(int most, int& n) {
  for (int i = 0; i < most; ++i) {
    const int one = co_await at_once(1);
    n += one;
  }
}

TEST(Task, ThatEndsAtOnceNeedsNoStack) {
  int n = 0;
  Running(count(1'000'000, n)).finish();
  EXPECT_EQ(n, 1'000'000);
}

TEST(WorkerPool, CallsLaterUnlessCancelled) {
  net::WorkerPool pool(2);
  net::Strand strand(pool);
  int in_order = 0;
  for (int i = 0; i < 100; ++i) strand.post([&, i] { in_order += in_order == i; });
  std::atomic<int> calls{0};
  const TimerPtr one = pool.call_at(in(1ms), [&](const TimerPtr&) { calls += 1; });
  const TimerPtr other = pool.call_at(in(1h), [&](const TimerPtr&) { calls += 100; });
  other->cancel();
  pool.join();
  EXPECT_EQ(in_order, 100);
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace truestep
