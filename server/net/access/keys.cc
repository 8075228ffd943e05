#include "server/net/access/keys.h"

#include <sys/stat.h>

#include <fstream>
#include <sstream>

#include "engine/base/errors.h"
#include "engine/base/log.h"
#include "server/net/access/digest.h"

namespace truestep::net {

namespace {
constexpr auto kLookEvery = std::chrono::seconds(1);
// Two writes within the resolution of a file's time stamp look like one.
constexpr int64_t kTimeResolution = 2;  // s
}  // namespace

KeyRing KeyRing::load(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw Error("bad_request", "the key file " + path + " cannot be read");
  KeyRing ring;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string name, key, scope, more;
    if (!(words >> name)) continue;
    if (!(words >> key)) std::swap(name, key);
    words >> scope;
    if ((!scope.empty() && scope != "admin") || words >> more) {
      throw Error("bad_request", "line " + std::to_string(number) + " of the key file " + path +
                                     " is not NAME KEY, NAME KEY admin or KEY");
    }
    std::string digest = key.starts_with("sha256:") ? key.substr(7) : sha256_hex(key);
    if (name.empty()) name = digest.substr(0, 12);
    ring.keys_.push_back(
        {{std::move(name), scope.empty() ? Caller::Scope::own : Caller::Scope::all}, std::move(digest)});
  }
  if (ring.keys_.empty()) throw Error("bad_request", "the key file " + path + " holds no key");
  return ring;
}

const Caller* KeyRing::find(std::string_view digest) const {
  const Caller* found = nullptr;
  for (const Key& k : keys_) {
    if (equal_constant_time(k.digest, digest)) found = &k.caller;
  }
  return found;
}

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
