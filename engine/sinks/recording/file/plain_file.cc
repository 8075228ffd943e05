#include "engine/sinks/recording/file/plain_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "engine/base/errors.h"

namespace truestep {

void throw_recording_error(const std::string& what, int code) {
  const char* kind = "recording_io";
  if (code == ENOSPC || code == EDQUOT || code == EFBIG) kind = "disk_full";
  if (code == EMFILE || code == ENFILE) kind = "overloaded";
  throw Error(kind, "could not " + what + ": " + std::strerror(code));
}

int open_plainly(const std::string& path, int flags) {
  return ::open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY, 0644);
}

std::optional<std::vector<std::byte>> read_plainly(const std::string& path) {
  const int fd = open_plainly(path, O_RDONLY);
  if (fd < 0) return std::nullopt;
  struct stat about {};
  std::optional<std::vector<std::byte>> bytes;
  if (::fstat(fd, &about) == 0 && S_ISREG(about.st_mode)) {
    bytes.emplace(static_cast<size_t>(about.st_size));
    for (size_t done = 0; bytes && done < bytes->size();) {
      const ssize_t n = ::read(fd, bytes->data() + done, bytes->size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) bytes.reset();
      done += n > 0 ? static_cast<size_t>(n) : 0;
    }
  }
  ::close(fd);
  return bytes;
}

void write_plainly(int fd, std::span<const std::byte> bytes, const std::string& what) {
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw_recording_error(what, n < 0 ? errno : ENOSPC);
    done += static_cast<size_t>(n);
  }
}

void create_plainly(const std::string& path, std::span<const std::byte> bytes, const std::string& what) {
  const int fd = open_plainly(path, O_CREAT | O_TRUNC | O_WRONLY);
  if (fd < 0) throw_recording_error(what, errno);
  try {
    write_plainly(fd, bytes, what);
  } catch (...) {
    ::close(fd);
    throw;
  }
  ::close(fd);
}

}  // namespace truestep
