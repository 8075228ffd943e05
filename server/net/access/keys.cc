#include "server/net/access/keys.h"

#include <sys/stat.h>

#include <ctime>

#include "engine/base/errors.h"
#include "engine/base/log.h"

namespace truestep::net {

namespace {
constexpr auto kLookEvery = std::chrono::seconds(1);
// Two writes within the resolution of a file's time stamp look like one.
constexpr int64_t kTimeResolution = 2;  // s
}  // namespace

KeyFile::KeyFile(std::string path) : path_(std::move(path)) {
  if (!asks()) return;
  read_ = stamp();
  ring_ = std::make_shared<const KeyRing>(KeyRing::load(path_));
}

KeyFile::Stamp KeyFile::stamp() const {
  struct stat info {};
  if (::stat(path_.c_str(), &info) != 0) return {};
  return {info.st_mtim.tv_sec, info.st_mtim.tv_nsec, static_cast<uint64_t>(info.st_size), info.st_ino};
}

std::shared_ptr<const KeyRing> KeyFile::keys() {
  const auto now = Clock::now().time_since_epoch().count();
  auto due = next_look_.load(std::memory_order_relaxed);
  const bool first =
      now >= due && next_look_.compare_exchange_strong(due, now + Clock::duration(kLookEvery).count());
  const std::lock_guard lock(mutex_);
  if (first && !(settled_ && stamp() == read_)) look("");
  return ring_;
}

void KeyFile::reload() {
  if (!asks()) return;
  const std::lock_guard lock(mutex_);
  look("as asked");
}

// Under the lock.
void KeyFile::look(std::string_view why) {
  const Stamp now = stamp();
  const bool changed = now != read_;
  read_ = now;
  settled_ = std::time(nullptr) - now.seconds > kTimeResolution;
  try {
    auto ring = std::make_shared<const KeyRing>(KeyRing::load(path_));
    if (changed || !why.empty()) log_info("the keys of {} are in use", path_);
    ring_ = std::move(ring);
    version_.fetch_add(1, std::memory_order_release);
  } catch (const Error& e) {
    if (changed || !why.empty()) log_error("the keys are unchanged: {}", e.what());
  }
}

}  // namespace truestep::net
