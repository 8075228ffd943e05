// Threads kept ready for many short loops in a row. ThreadArena wakes its threads for every loop, which costs
// more than a loop of a few microseconds is worth; a team's helpers spin between loops, but only while they
// are gathered. Blocks are those of ThreadArena: the same bits for any number of threads. Helpers take blocks
// as they arrive; if none ever arrives, the caller does them all.
#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>

#include "engine/base/parallel.h"

namespace truestep {

class ThreadTeam {
 public:
  ThreadTeam();
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  /// Helpers wait for loops while this object lives.
  class Gathering {
   public:
    explicit Gathering(ThreadTeam& team) : team_(team) {}
    ~Gathering() { team_.dismiss(); }
    Gathering(const Gathering&) = delete;
    Gathering& operator=(const Gathering&) = delete;

   private:
    ThreadTeam& team_;
  };
  /// Gathers as many threads as the arena may use; only the caller's when that is one.
  [[nodiscard]] Gathering gather(const ThreadArena& arena);

  /// body(begin, end) for every block of at most `block` elements of [0, n). It must not throw. One loop at a
  /// time, from the thread that gathered the team.
  template <class Body>
  void for_blocks(size_t n, size_t block, Body&& body) const {
    if (!gathered_ || n <= block) {
      for (size_t b = 0; b < n; b += block) body(b, std::min(n, b + block));
      return;
    }
    using Plain = std::remove_reference_t<Body>;
    const auto call = [](void* of, size_t begin, size_t end) { (*static_cast<Plain*>(of))(begin, end); };
    run(n, block, call, const_cast<void*>(static_cast<const void*>(std::addressof(body))));
  }

 private:
  struct Work;
  void dismiss();
  using Call = void (*)(void*, size_t, size_t);
  void run(size_t n, size_t block, Call call, void* body) const;
  std::shared_ptr<Work> work_;
  bool gathered_ = false;
};

}  // namespace truestep
