#include "server/data/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <tuple>
#include <utility>

#include "engine/base/errors.h"

namespace truestep {

namespace {

constexpr const char* kName = "server.lock";

std::string holder() {
  char host[256] = "unknown";
  ::gethostname(host, sizeof host - 1);
  char since[32];
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::strftime(since, sizeof since, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return "process " + std::to_string(::getpid()) + " on " + host + ", started " + since + "\n";
}

// What the holder wrote, in printable characters; empty if it has not written yet.
std::string read_holder(int fd) {
  char text[400];
  const ssize_t n = ::pread(fd, text, sizeof text, 0);
  std::string line;
  for (ssize_t i = 0; i < n && text[i] != '\n'; ++i) {
    if (text[i] >= ' ' && text[i] <= '~') line += text[i];
  }
  return line.empty() ? "another process" : line;
}

[[noreturn]] void unusable(const std::string& path, const char* what) {
  throw Error("folder_unusable", path + " cannot be " + what + ": " + std::strerror(errno));
}

}  // namespace

FolderLock::FolderLock(const std::string& folder) {
  const std::string path = folder + "/" + kName;
  fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (fd_ < 0) unusable(path, "written");
  while (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    const bool held = errno == EWOULDBLOCK;
    const int code = errno;
    const std::string by = held ? read_holder(fd_) : "";
    ::close(std::exchange(fd_, -1));
    errno = code;
    if (!held) unusable(path, "locked");
    throw Error("folder_locked", "the data folder " + folder + " is in use by " + by +
                                     "; end that server, or choose another folder with --data-dir");
  }
  // On a full disk the lock still holds; only the holder's name is missing.
  const std::string text = holder();
  if (::ftruncate(fd_, 0) == 0) std::ignore = ::pwrite(fd_, text.data(), text.size(), 0);
}

FolderLock::FolderLock(FolderLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

FolderLock& FolderLock::operator=(FolderLock&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

FolderLock::~FolderLock() {
  // The file stays: if it were removed, two servers could each lock a file of this name.
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace truestep
