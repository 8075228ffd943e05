// The only thread of a process on which HDF5 runs: the serial library is not thread-safe, so all recordings
// and readers share it. The queue is bounded in bytes; a producer that is too fast has to wait, because a gap
// in a file is a lie.
#pragma once
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace truestep {

/// Work for the thread. `run` owns the task, so that its memory can be returned to where it came from.
class RecordingTask {
 public:
  virtual ~RecordingTask() = default;
  virtual void run(std::unique_ptr<RecordingTask> self) noexcept = 0;
  virtual size_t bytes() const = 0;  ///< counted against the queue's bound while it waits or runs
};

/// Create one per process and share it; a second one at the same time throws Error("internal").
class RecordingThread {
 public:
  static constexpr size_t kDefaultQueueBytes = size_t{16} << 20;

  explicit RecordingThread(size_t queue_bytes = kDefaultQueueBytes);
  ~RecordingThread();  ///< runs what is queued, then stops
  RecordingThread(const RecordingThread&) = delete;
  RecordingThread& operator=(const RecordingThread&) = delete;

  /// Queues `task`; waits while the queue is above its bound (a larger task waits for an empty queue).
  void post(std::unique_ptr<RecordingTask> task);

  /// Runs `work` on the thread after the queued tasks and waits for it; its exceptions are rethrown here.
  void run(const std::function<void()>& work);

 private:
  void loop();

  const size_t queue_bytes_;
  std::mutex mutex_;
  std::condition_variable not_empty_, not_full_;
  std::deque<std::unique_ptr<RecordingTask>> queue_;
  size_t bytes_ = 0;
  enum class Phase { kRunning, kStopping } phase_ = Phase::kRunning;
  std::thread thread_;
};

}  // namespace truestep
