#include "server/persistence/place.h"

#include <dirent.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "engine/base/errors.h"

namespace truestep {

namespace {

constexpr int kNoLinks = O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY;
constexpr int kAsFolder = O_RDONLY | O_DIRECTORY | kNoLinks;

// Names in an open folder, which is closed.
std::vector<std::string> names_in(int folder) {
  std::vector<std::string> names;
  DIR* stream = ::fdopendir(folder);
  if (!stream) {
    if (folder >= 0) ::close(folder);
    return names;
  }
  while (const dirent* entry = ::readdir(stream)) {
    const std::string_view name = entry->d_name;
    if (name != "." && name != "..") names.emplace_back(name);
  }
  ::closedir(stream);
  return names;
}

void remove_below(int at, const char* name) {
  if (::unlinkat(at, name, 0) == 0 || errno == ENOENT) return;
  const Descriptor folder(::openat(at, name, kAsFolder));
  if (folder.get() < 0) return;
  for (const std::string& inner : names_in(::fcntl(folder.get(), F_DUPFD_CLOEXEC, 0)))
    remove_below(folder.get(), inner.c_str());
  ::unlinkat(at, name, AT_REMOVEDIR);
}

}  // namespace

Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

Descriptor::Descriptor(Descriptor&& other) noexcept : fd_(other.release()) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

int Descriptor::release() {
  return std::exchange(fd_, -1);
}

void throw_file_error(const std::string& what, int code) {
  const bool full = code == ENOSPC || code == EDQUOT || code == EFBIG;
  if (code == EMFILE || code == ENFILE)
    throw Error("overloaded", "no more files can be opened: cannot " + what);
  throw Error(full ? "disk_full" : "folder_io", "cannot " + what + ": " + std::strerror(code));
}

// --- where it is

Place Place::folder(const std::string& path) {
  Place place;
  place.root_ = std::make_shared<const Descriptor>(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (place.root_->get() < 0) throw_file_error("open the data folder", errno);
  return place;
}

Place Place::operator/(std::string_view name) const {
  Place place = *this;
  place.names_.emplace_back(name);
  return place;
}

Place Place::with_ending(std::string_view ending) const {
  Place place = *this;
  place.names_.back() += ending;
  return place;
}

Place Place::parent() const {
  Place place = *this;
  place.names_.pop_back();
  return place;
}

/// The folder that holds the last name; errno when there is no way to it.
struct Place::Way {
  Descriptor opened;
  int folder;
  const char* name;
  int code;
};

Place::Way Place::way() const {
  Way way{Descriptor(-1), root_->get(), names_.empty() ? "." : names_.back().c_str(), 0};
  for (size_t k = 0; k + 1 < names_.size(); ++k) {
    way.opened = Descriptor(::openat(way.folder, names_[k].c_str(), O_PATH | kAsFolder));
    way.folder = way.opened.get();
    if (way.folder < 0) {
      way.code = errno;
      break;
    }
  }
  return way;
}

// --- what is there

Descriptor Place::try_open(int flags) const {
  const Way way = this->way();
  if (way.code) errno = way.code;
  return Descriptor(way.code ? -1 : ::openat(way.folder, way.name, flags | kNoLinks, 0644));
}

Descriptor Place::open(int flags, const char* what) const {
  Descriptor file = try_open(flags);
  if (file.get() >= 0) return file;
  const int code = errno;
  const std::string named = names_.empty() ? "the data folder" : name();
  if (code == ENOENT && (flags & O_ACCMODE) == O_RDONLY)
    throw Error("session_damaged", named + " is missing");
  // A link, or something that is no folder on the way to it.
  if (code == ELOOP || code == ENOTDIR || code == ENXIO)
    throw Error("session_damaged", named + " is no regular file, or no folder of this server's leads to it");
  throw_file_error(std::string(what) + " " + named, code);
}

std::optional<struct stat> Place::status() const {
  const Way way = this->way();
  struct stat about {};
  if (way.code || ::fstatat(way.folder, way.name, &about, AT_SYMLINK_NOFOLLOW) != 0) return std::nullopt;
  return about;
}

bool Place::is_regular() const {
  const auto about = status();
  return about && S_ISREG(about->st_mode);
}

bool Place::is_surely_regular() const {
  const Way way = this->way();
  struct stat about {};
  int code = way.code;
  if (!code && ::fstatat(way.folder, way.name, &about, AT_SYMLINK_NOFOLLOW) != 0) code = errno;
  if (code == ENOENT || code == ENOTDIR || code == ELOOP) return false;
  if (code) throw_file_error("look for " + name(), code);
  return S_ISREG(about.st_mode);
}

std::vector<std::string> Place::names() const {
  const Way way = this->way();
  return way.code ? std::vector<std::string>() : names_in(::openat(way.folder, way.name, kAsFolder));
}

// --- changes

void Place::make_folder() const {
  const Way way = this->way();
  int code = way.code;
  if (!code && ::mkdirat(way.folder, way.name, 0777) != 0) code = errno;
  if (code == EEXIST) {
    const auto about = status();
    code = 0;
    if (!about || !S_ISDIR(about->st_mode))
      throw Error("folder_io", "there is something else than a folder of the name " + name() +
                                   " in the data folder (links are not followed there)");
  }
  if (code) throw_file_error("make the folder " + name(), code);
}

int Place::rename_to(const Place& other) const {
  const Way from = way(), to = other.way();
  if (from.code || to.code) return from.code ? from.code : to.code;
  return ::renameat(from.folder, from.name, to.folder, to.name) == 0 ? 0 : errno;
}

int Place::remove() const {
  const Way way = this->way();
  if (way.code) return way.code;
  return ::unlinkat(way.folder, way.name, 0) == 0 ? 0 : errno;
}

void Place::remove_all() const {
  const Way way = this->way();
  if (!way.code) remove_below(way.folder, way.name);
}

std::string path_of(const Descriptor& file) {
  return "/proc/self/fd/" + std::to_string(file.get());
}

std::string Place::path() const {
  std::string path = path_of(*root_);
  for (const std::string& name : names_) path += "/" + name;
  return path;
}

}  // namespace truestep
