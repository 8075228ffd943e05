#include "server/sessions/lane.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>

#include "engine/base/log.h"

namespace truestep {

void yield_to_others(int niceness) {
  // On Linux, niceness is a property of a thread.
  if (niceness != 0) setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), niceness);
}

Lane::Lane(int threads, int niceness) {
  for (int k = 0; k < std::max(1, threads); ++k) threads_.emplace_back([this, niceness] { work(niceness); });
}

Lane::~Lane() {
  stop();
}

bool Lane::add(double& used, std::function<void()> turn) {
  const std::lock_guard lock(mutex_);
  if (stopping_) return false;
  used = std::max(used, floor_);
  waiting_.emplace(used, std::move(turn));
  wake_.notify_one();
  return true;
}

void Lane::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& t : threads_) {
    if (t.joinable()) t.join();
  }
}

void Lane::work(int niceness) {
  yield_to_others(niceness);
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    auto next = waiting_.extract(waiting_.begin());
    floor_ = std::max(floor_, next.key());
    lock.unlock();
    try {
      next.mapped()();
    } catch (const std::exception& e) {
      log_error("work: {}", e.what());
    }
    // Release what the turn captured before taking the lock: its destructor may add turns.
    next = {};
    lock.lock();
  }
}

}  // namespace truestep
