#include "engine/sinks/recording/file/plain_file.h"

#include <fcntl.h>
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

void write_plainly(int fd, std::span<const std::byte> bytes, const std::string& what) {
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw_recording_error(what, n < 0 ? errno : ENOSPC);
    done += static_cast<size_t>(n);
  }
}

void create_plainly(const std::string& path, std::span<const std::byte> bytes, const std::string& what) {
  const int fd = ::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644);
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
