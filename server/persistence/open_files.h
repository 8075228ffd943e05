// Files that are written often, by far more owners than there may be file descriptors: the most recently
// written stay open, the others are reopened when needed.
#pragma once
#include <list>
#include <memory>
#include <mutex>

#include "server/persistence/place.h"

namespace truestep {

class OpenFiles {
 public:
  explicit OpenFiles(size_t most = 32) : most_(most) {}
  /// The owner's file, open for writing and made if it is missing; it stays open at least while the pointer
  /// is held. Any thread. Errors of Place::open.
  std::shared_ptr<Descriptor> open(const void* owner, const Place& place);
  void close(const void* owner);

 private:
  struct Kept {
    const void* owner;
    std::shared_ptr<Descriptor> file;
  };
  const size_t most_;
  std::mutex mutex_;
  std::list<Kept> files_;  ///< most recently used first
};

}  // namespace truestep
