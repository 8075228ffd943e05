#include "server/persistence/open_files.h"

#include <algorithm>

namespace truestep {

std::shared_ptr<Descriptor> OpenFiles::open(const void* owner, const Place& place) {
  const std::lock_guard lock(mutex_);
  const auto it = std::find_if(files_.begin(), files_.end(), [&](const Kept& k) { return k.owner == owner; });
  if (it != files_.end()) {
    files_.splice(files_.begin(), files_, it);
    return files_.front().file;
  }
  auto file = std::make_shared<Descriptor>(place.open(O_WRONLY | O_CREAT, "open"));
  files_.push_front({owner, file});
  if (files_.size() > most_) files_.pop_back();
  return file;
}

void OpenFiles::close(const void* owner) {
  const std::lock_guard lock(mutex_);
  files_.remove_if([&](const Kept& k) { return k.owner == owner; });
}

}  // namespace truestep
