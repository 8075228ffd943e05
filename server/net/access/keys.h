// The API keys: who may use the service and what each may see. The key file is re-read while the server runs,
// so that keys can be added and withdrawn without a restart.
#pragma once
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/net/http/message.h"

namespace truestep::net {

/// The keys of a file. A line is "NAME KEY", "NAME KEY admin" or "KEY", where any key may be given as
/// "sha256:" and 64 hexadecimal digits, and has at least 20 characters otherwise; '#' starts a comment. Keys
/// of one name see the same sessions; an admin key sees everybody's. Only digests stay in memory; every key
/// is compared in constant time.
class KeyRing {
 public:
  static constexpr size_t kShortestKey = 20;  ///< characters
  /// Throws Error("bad_request") when the file cannot be read whole, has a malformed line or holds no key.
  static KeyRing load(const std::string& path);
  /// The same of a file's text; `what` names it in errors.
  static KeyRing read(std::string_view text, const std::string& what);
  /// The owner of the key with this digest (the first 12 digits name a key without a name); null: nobody.
  const Caller* find(std::string_view digest) const;
  size_t size() const { return keys_.size(); }

 private:
  struct Key {
    Caller caller;
    std::string digest;
  };
  std::vector<Key> keys_;
};

/// A key file that may change.
class KeyFile {
 public:
  using Clock = std::chrono::steady_clock;
  /// Without a path, no key is required. Error as KeyRing::load.
  explicit KeyFile(std::string path);

  bool asks() const { return !path_.empty(); }
  /// The current keys. The file's time stamp is checked at most once a second; an unusable file changes
  /// nothing and is reported in the log.
  std::shared_ptr<const KeyRing> keys();
  /// Reads the file at once, whatever its time stamp says.
  void reload();
  /// Grows whenever the keys change.
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
  Stamp read_;            ///< of the file when it was last read
  bool settled_ = false;  ///< a change after that reading would show in the file's time stamp
};

}  // namespace truestep::net
