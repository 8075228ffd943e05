#include "server/data/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
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

bool lock(int fd) {
  while (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EINTR) return false;
  }
  return true;
}

[[noreturn]] void unusable(const std::string& path, const char* what) {
  throw Error("folder_unusable", path + " cannot be " + what + ": " + std::strerror(errno));
}

}  // namespace

FolderLock::FolderLock(const std::string& folder) : folder_(folder) {
  const std::string path = folder + "/" + kName;
  folder_fd_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder_fd_ < 0) unusable(folder, "opened");
  fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644);
  if (fd_ < 0) {
    const int code = errno;
    let_go();
    errno = code;
    unusable(path, "written");
  }
  for (const int fd : {folder_fd_, fd_}) {
    if (lock(fd)) continue;
    const bool held = errno == EWOULDBLOCK;
    if (!held && fd == folder_fd_) continue;  // a file system that locks only files
    const int code = errno;
    const std::string by = held ? read_holder(fd_) : "";
    let_go();
    errno = code;
    if (!held) unusable(path, "locked");
    throw Error("folder_locked", "the data folder " + folder + " is in use by " + by +
                                     "; end that server, or choose another folder with --data-dir");
  }
  // On a full disk the lock still holds; only the holder's name is missing.
  const std::string text = holder();
  if (::ftruncate(fd_, 0) == 0) std::ignore = ::pwrite(fd_, text.data(), text.size(), 0);
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : folder_(std::move(other.folder_)),
      folder_fd_(std::exchange(other.folder_fd_, -1)),
      fd_(std::exchange(other.fd_, -1)) {}

FolderLock& FolderLock::operator=(FolderLock&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(folder_fd_, other.folder_fd_);
  std::swap(fd_, other.fd_);
  return *this;
}

FolderLock::~FolderLock() {
  let_go();
}

// The file stays: if it were removed, two servers could each lock a file of this name.
void FolderLock::let_go() {
  for (int* fd : {&fd_, &folder_fd_}) {
    if (*fd >= 0) ::close(std::exchange(*fd, -1));
  }
}

std::string FolderLock::problem() const {
  struct stat held {
  }, there{};
  if (folder_fd_ < 0 || ::fstat(folder_fd_, &held) != 0) return "";
  if (::stat(folder_.c_str(), &there) != 0)
    return "the data folder is gone while the server runs: " + std::string(std::strerror(errno));
  if (held.st_ino != there.st_ino || held.st_dev != there.st_dev)
    return "the data folder was replaced by another one while the server runs";
  return "";
}

}  // namespace truestep
