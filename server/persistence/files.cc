#include "server/persistence/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>

#include "engine/base/errors.h"

namespace truestep {

namespace {

// Up to `size` bytes, fewer at the end of the file.
Bytes read_from(int fd, size_t size, const Place& place) {
  Bytes bytes(size);
  size_t done = 0;
  while (done < size) {
    const ssize_t n = ::read(fd, bytes.data() + done, size - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw_file_error("read " + place.name(), errno);
    if (n == 0) break;
    done += static_cast<size_t>(n);
  }
  bytes.resize(done);
  return bytes;
}

// Its size.
uint64_t require_regular(const Descriptor& file, const Place& place) {
  struct stat about {};
  if (::fstat(file.get(), &about) != 0) throw_file_error("read " + place.name(), errno);
  if (!S_ISREG(about.st_mode)) throw Error("session_damaged", place.name() + " is no regular file");
  return static_cast<uint64_t>(about.st_size);
}

void sync(const Place& place, int flags) {
  const Descriptor file = place.open(flags, "open");
  if (::fsync(file.get()) != 0) throw_file_error("keep " + place.name(), errno);
}

void write_whole(const Place& place, std::span<const std::byte> bytes, Durability durability) {
  const Descriptor file = place.open(O_WRONLY | O_CREAT | O_TRUNC, "create");
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(file.get(), bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw_file_error("write " + place.name(), n < 0 ? errno : ENOSPC);
    done += static_cast<size_t>(n);
  }
  if (durability == Durability::power && ::fsync(file.get()) != 0)
    throw_file_error("keep " + place.name(), errno);
}

Place fresh_name(const Place& place) {
  static std::atomic<uint64_t> count{0};
  return place.with_ending(".new" + std::to_string(++count));
}

}  // namespace

void write_in_fresh_folder(const Place& place, std::span<const std::byte> bytes) {
  write_whole(place, bytes, Durability::process);
}

FreshFile::FreshFile(const Place& place, std::span<const std::byte> bytes, Durability durability)
    : place_(place), fresh_(fresh_name(place)) {
  try {
    write_whole(fresh_, bytes, durability);
  } catch (...) {
    fresh_.remove();
    throw;
  }
}

FreshFile::~FreshFile() {
  if (waits_) fresh_.remove();
}

void FreshFile::commit() {
  if (const int code = fresh_.rename_to(place_)) throw_file_error("name " + place_.name(), code);
  waits_ = false;
}

void write_file(const Place& place, std::span<const std::byte> bytes, Durability durability) {
  FreshFile file(place, bytes, durability);
  file.commit();
  if (durability == Durability::power) sync(place.parent(), O_RDONLY | O_DIRECTORY);
}

void harden_file(const Place& place) {
  sync(place, O_RDONLY);
  sync(place.parent(), O_RDONLY | O_DIRECTORY);
}

void sync_disk_of(const Place& folder) {
  const Descriptor file = folder.open(O_RDONLY | O_DIRECTORY, "open");
  ::syncfs(file.get());
}

Bytes read_file(const Place& place, size_t most) {
  const Descriptor file = place.open(O_RDONLY, "read");
  const uint64_t size = require_regular(file, place);
  if (size > most) throw Error("session_damaged", place.name() + " is too long");
  return read_from(file.get(), size, place);
}

Bytes read_head(const Place& place, size_t most) {
  const Descriptor file = place.open(O_RDONLY, "read");
  require_regular(file, place);
  return read_from(file.get(), most, place);
}

double folder_bytes(const Place& folder) {
  double sum = 0;
  for (const std::string& name : folder.names()) {
    const Place place = folder / name;
    const auto about = place.status();
    if (about && S_ISREG(about->st_mode)) sum += static_cast<double>(about->st_size);
    if (about && S_ISDIR(about->st_mode)) sum += folder_bytes(place);
  }
  return sum;
}

}  // namespace truestep
