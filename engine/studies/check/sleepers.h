// What sleeps must be what would rest: rows found asleep are woken and compared with those left alone.
#pragma once
#include <memory>

#include "engine/session/session.h"

namespace truestep {

/// Looks at the first system a few times per run, whenever more of its rows sleep than before.
class Sleepers {
 public:
  void add(const Session& session, const std::shared_ptr<const ThreadArena>& arena);
  /// m by which a sleeping row moved within 0.4 s of being woken, and when that was (s).
  double moved() const { return most_; }
  double at() const { return at_; }

 private:
  size_t before_ = 0, looks_ = 0;
  double most_ = 0, at_ = 0;
};

}  // namespace truestep
