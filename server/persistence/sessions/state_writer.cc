#include "server/persistence/sessions/state_writer.h"

#include "engine/base/log.h"
#include "server/sessions/lane.h"

namespace truestep {

namespace {
constexpr int kNice = 10;
}

StateWriter::StateWriter() : thread_([this] { run(); }) {}

StateWriter::~StateWriter() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void StateWriter::post(std::function<void()> work) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(work));
  }
  wake_.notify_one();
}

void StateWriter::run() {
  yield_to_others(kNice);
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    auto work = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    try {
      work();
    } catch (const std::exception& e) {
      log_error("saving a session: {}", e.what());
    }
    work = nullptr;
    lock.lock();
  }
}

}  // namespace truestep
