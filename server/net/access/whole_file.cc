#include "server/net/access/whole_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "engine/base/errors.h"

namespace truestep::net {

namespace {

struct Closing {
  int fd;
  ~Closing() {
    if (fd >= 0) ::close(fd);
  }
};

}  // namespace

std::string read_whole_file(const std::string& path, const std::string& what, size_t most) {
  const auto fail = [&](const std::string& why) { throw Error("bad_request", what + " " + why); };
  const auto refused = [&] { fail(std::string("cannot be read: ") + std::strerror(errno)); };
  // The opening of a FIFO would wait for its writer.
  const Closing file{::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)};
  if (file.fd < 0) refused();
  struct stat before {
  }, after{};
  if (::fstat(file.fd, &before) != 0) refused();
  if (!S_ISREG(before.st_mode)) fail("is not a regular file");
  const auto size = static_cast<uint64_t>(before.st_size);
  if (size > most) fail("is longer than " + std::to_string(most) + " bytes");
  // One more byte than there should be shows that it grows.
  std::string text(static_cast<size_t>(size) + 1, '\0');
  size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = ::read(file.fd, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) refused();
    if (n == 0) break;
    done += static_cast<size_t>(n);
  }
  if (::fstat(file.fd, &after) != 0) refused();
  const bool same = done == size && after.st_size == before.st_size &&
                    after.st_mtim.tv_sec == before.st_mtim.tv_sec &&
                    after.st_mtim.tv_nsec == before.st_mtim.tv_nsec;
  if (!same) fail("changes while it is read");
  text.resize(done);
  return text;
}

}  // namespace truestep::net
