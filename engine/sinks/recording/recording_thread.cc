#include "engine/sinks/recording/recording_thread.h"

#include <atomic>
#include <exception>
#include <future>

#include "engine/base/errors.h"
#include "engine/sinks/recording/file/h5.h"

namespace truestep {
namespace {

std::atomic<int> threads_alive{0};

// A call that somebody waits for; it takes no space in the queue.
struct WaitedTask final : RecordingTask {
  const std::function<void()>& work;
  std::promise<void>& done;
  WaitedTask(const std::function<void()>& w, std::promise<void>& d) : work(w), done(d) {}
  void run(std::unique_ptr<RecordingTask>) noexcept override {
    try {
      work();
      done.set_value();
    } catch (...) {
      done.set_exception(std::current_exception());
    }
  }
  size_t bytes() const override { return 0; }
};

}  // namespace

RecordingThread::RecordingThread(size_t queue_bytes) : queue_bytes_(queue_bytes) {
  if (threads_alive.fetch_add(1) != 0) {
    --threads_alive;
    throw Error("internal", "a process has one recording thread");
  }
  thread_ = std::thread([this] { loop(); });
}

RecordingThread::~RecordingThread() {
  {
    std::lock_guard lock(mutex_);
    phase_ = Phase::kStopping;
  }
  not_empty_.notify_all();
  thread_.join();
  --threads_alive;
}

void RecordingThread::post(std::unique_ptr<RecordingTask> task) {
  const size_t size = task->bytes();
  {
    std::unique_lock lock(mutex_);
    not_full_.wait(lock, [&] { return size == 0 || bytes_ == 0 || bytes_ + size <= queue_bytes_; });
    bytes_ += size;
    queue_.push_back(std::move(task));
  }
  not_empty_.notify_one();
}

void RecordingThread::run(const std::function<void()>& work) {
  if (std::this_thread::get_id() == thread_.get_id()) return work();
  std::promise<void> done;
  std::future<void> finished = done.get_future();
  post(std::make_unique<WaitedTask>(work, done));
  finished.get();
}

void RecordingThread::loop() {
  h5_quiet();
  std::unique_lock lock(mutex_);
  for (;;) {
    not_empty_.wait(lock, [&] { return !queue_.empty() || phase_ == Phase::kStopping; });
    if (queue_.empty()) return;
    std::unique_ptr<RecordingTask> task = std::move(queue_.front());
    queue_.pop_front();
    const size_t size = task->bytes();
    lock.unlock();
    RecordingTask& t = *task;
    t.run(std::move(task));
    lock.lock();
    bytes_ -= size;
    not_full_.notify_all();
  }
}

}  // namespace truestep
