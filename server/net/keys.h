// The API keys: who may use the service and what each may see. The file that holds them is looked at again
// while the server runs, so that keys come and go without a restart.
#pragma once
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/net/message.h"

namespace truestep::net {

/// The keys of a file. A line is "NAME KEY", "NAME KEY admin" or "KEY", with "sha256:HEX" in place of any
/// key;
/// '#' comments. Keys of one name see the same sessions; an admin key sees everybody's. Only digests stay in
/// memory; every key is compared in constant time.
class KeyRing {
 public:
  /// Throws Error("bad_request") when the file cannot be read, has a malformed line or holds no key.
  static KeyRing load(const std::string& path);
  /// Who presents a key of this digest (its first 12 digits name a key without a name); null: nobody.
  const Caller* find(std::string_view digest) const;

 private:
  struct Key {
    Caller caller;
    std::string digest;
  };
  std::vector<Key> keys_;
};

/// A file of keys that may change.
class KeyFile {
 public:
  using Clock = std::chrono::steady_clock;
  /// Without a path: asks nobody for a key. Error as KeyRing::load.
  explicit KeyFile(std::string path);

  bool asks() const { return !path_.empty(); }
  /// The keys as they are now. The file's time is looked at once a second at most; a file that cannot be used
  /// changes nothing and is reported in the log.
  std::shared_ptr<const KeyRing> keys();
  /// Reads the file at once, whatever its time says.
  void reload();
  /// Grows whenever other keys are in force.
  uint64_t version() const { return version_.load(std::memory_order_acquire); }

 private:
  struct Stamp {
    int64_t seconds = 0, nanoseconds = 0;
    uint64_t size = 0, inode = 0;
    friend bool operator==(const Stamp&, const Stamp&) = default;
  };
  Stamp stamp() const;
  void look(std::string_view why);

  const std::string path_;
  std::atomic<Clock::rep> next_look_{0};
  std::atomic<uint64_t> version_{1};
  std::mutex mutex_;
  std::shared_ptr<const KeyRing> ring_;
  Stamp read_;            ///< of the file when it was read last
  bool settled_ = false;  ///< a change after that reading shows in the file's time
};

}  // namespace truestep::net
