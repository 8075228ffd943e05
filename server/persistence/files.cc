#include "server/persistence/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <utility>

#include "engine/base/errors.h"

namespace truestep {

namespace fs = std::filesystem;

namespace {

class Descriptor {
 public:
  // Never waits for what is at the other end of a FIFO, nor follows a link.
  Descriptor(const fs::path& path, int flags, const char* what)
      : fd_(::open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY, 0644)) {
    if (fd_ >= 0) return;
    if (errno == ENOENT && (flags & O_ACCMODE) == O_RDONLY)
      throw Error("session_damaged", path.filename().string() + " is missing");
    // A link, or something that is no folder on the way to it.
    if (errno == ELOOP || errno == ENOTDIR || errno == ENXIO)
      throw Error("session_damaged", path.filename().string() + " is no regular file");
    throw_file_error(std::string(what) + " " + path.filename().string(), errno);
  }
  ~Descriptor() { ::close(fd_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

// Up to `size` bytes, fewer at the end of the file.
Bytes read_from(int fd, size_t size, const fs::path& path) {
  Bytes bytes(size);
  size_t done = 0;
  while (done < size) {
    const ssize_t n = ::read(fd, bytes.data() + done, size - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw_file_error("read " + path.filename().string(), errno);
    if (n == 0) break;
    done += static_cast<size_t>(n);
  }
  bytes.resize(done);
  return bytes;
}

// Its size.
uint64_t require_regular(const Descriptor& file, const fs::path& path) {
  struct stat about {};
  if (::fstat(file.get(), &about) != 0) throw_file_error("read " + path.filename().string(), errno);
  if (!S_ISREG(about.st_mode))
    throw Error("session_damaged", path.filename().string() + " is no regular file");
  return static_cast<uint64_t>(about.st_size);
}

void sync(const fs::path& path, int flags) {
  const Descriptor file(path, flags, "open");
  if (::fsync(file.get()) != 0) throw_file_error("keep " + path.filename().string(), errno);
}

}  // namespace

void throw_file_error(const std::string& what, int code) {
  const bool full = code == ENOSPC || code == EDQUOT || code == EFBIG;
  if (code == EMFILE || code == ENFILE)
    throw Error("overloaded", "no more files can be opened: cannot " + what);
  throw Error(full ? "disk_full" : "folder_io", "cannot " + what + ": " + std::strerror(code));
}

namespace {

void write_whole(const fs::path& path, std::span<const std::byte> bytes, Durability durability) {
  const Descriptor file(path, O_WRONLY | O_CREAT | O_TRUNC, "create");
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(file.get(), bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw_file_error("write " + path.filename().string(), n < 0 ? errno : ENOSPC);
    done += static_cast<size_t>(n);
  }
  if (durability == Durability::power && ::fsync(file.get()) != 0)
    throw_file_error("keep " + path.filename().string(), errno);
}

}  // namespace

void write_in_fresh_folder(const fs::path& path, std::span<const std::byte> bytes) {
  write_whole(path, bytes, Durability::process);
}

FreshFile::FreshFile(fs::path path, std::span<const std::byte> bytes, Durability durability)
    : path_(std::move(path)), fresh_(path_) {
  static std::atomic<uint64_t> count{0};
  fresh_ += ".new" + std::to_string(++count);
  try {
    write_whole(fresh_, bytes, durability);
  } catch (...) {
    ::unlink(fresh_.c_str());
    throw;
  }
}

FreshFile::~FreshFile() {
  if (waits_) ::unlink(fresh_.c_str());
}

void FreshFile::commit() {
  if (::rename(fresh_.c_str(), path_.c_str()) != 0)
    throw_file_error("name " + path_.filename().string(), errno);
  waits_ = false;
}

void write_file(const fs::path& path, std::span<const std::byte> bytes, Durability durability) {
  FreshFile file(path, bytes, durability);
  file.commit();
  if (durability == Durability::power) sync(path.parent_path(), O_RDONLY | O_DIRECTORY);
}

void harden_file(const fs::path& path) {
  sync(path, O_RDONLY);
  sync(path.parent_path(), O_RDONLY | O_DIRECTORY);
}

void sync_disk_of(const fs::path& folder) {
  const Descriptor file(folder, O_RDONLY | O_DIRECTORY, "open");
  ::syncfs(file.get());
}

Bytes read_file(const fs::path& path, size_t most) {
  const Descriptor file(path, O_RDONLY, "read");
  const uint64_t size = require_regular(file, path);
  if (size > most) throw Error("session_damaged", path.filename().string() + " is too long");
  return read_from(file.get(), size, path);
}

Bytes read_head(const fs::path& path, size_t most) {
  const Descriptor file(path, O_RDONLY, "read");
  require_regular(file, path);
  return read_from(file.get(), most, path);
}

bool is_regular(const fs::path& path) {
  std::error_code none;
  return fs::is_regular_file(fs::symlink_status(path, none));
}

double folder_bytes(const fs::path& folder) {
  double sum = 0;
  std::error_code failed;
  for (fs::recursive_directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
    std::error_code gone;
    if (it->is_regular_file(gone)) sum += static_cast<double>(it->file_size(gone));
  }
  return sum;
}

}  // namespace truestep
