// Answers remembered under a client's Idempotency-Key, so that a repeated request gets the same answer and is
// not carried out again.
#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace truestep {

struct RememberedAnswer {
  uint64_t request_hash = 0;
  int status = 0;
  std::string body, location;
  std::string media{};  ///< type of the body
};

class IdempotencyKeys {
 public:
  explicit IdempotencyKeys(size_t capacity = 10000) : capacity_(capacity) {}
  // Keys are "<caller>\n<key>". Of too many, the oldest of the caller with the most is forgotten: no caller
  // makes another's request be carried out twice.
  /// The answer given before. Error "idempotency_key_reused" when the key belonged to a different request,
  /// "conflict" while the first one is still being answered. Empty: the key is now reserved, and remember or
  /// forget must follow.
  std::optional<RememberedAnswer> begin(const std::string& key, uint64_t request_hash);
  void remember(const std::string& key, RememberedAnswer answer);
  void forget(const std::string& key);

 private:
  struct Slot {
    RememberedAnswer answer;
    enum class Stage { running, done } stage = Stage::running;
  };
  void make_room();
  size_t capacity_;
  std::mutex mutex_;
  std::map<std::string, Slot> slots_;
  std::map<std::string, std::deque<std::string>> order_;  ///< of every caller, oldest first; none is empty
};

}  // namespace truestep
