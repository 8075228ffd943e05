#include "server/persistence/open_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "server/persistence/files.h"

namespace truestep {

OpenFile::OpenFile(const std::filesystem::path& path)
    : fd_(::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644)) {
  if (fd_ < 0) throw_file_error("open " + path.filename().string(), errno);
}

OpenFile::~OpenFile() {
  ::close(fd_);
}

std::shared_ptr<OpenFile> OpenFiles::open(const void* owner, const std::filesystem::path& path) {
  const std::lock_guard lock(mutex_);
  const auto it = std::find_if(files_.begin(), files_.end(), [&](const Kept& k) { return k.owner == owner; });
  if (it != files_.end()) {
    files_.splice(files_.begin(), files_, it);
    return files_.front().file;
  }
  auto file = std::make_shared<OpenFile>(path);
  files_.push_front({owner, file});
  if (files_.size() > most_) files_.pop_back();
  return file;
}

void OpenFiles::close(const void* owner) {
  const std::lock_guard lock(mutex_);
  files_.remove_if([&](const Kept& k) { return k.owner == owner; });
}

}  // namespace truestep
