// A place in the data folder: names below a handle of the folder. Every folder on the way is opened from the
// one before, and none of the names is followed when it is a link: whatever is swapped while the server runs,
// nothing beside the folder is read, written, renamed or removed. All of server/persistence reaches its files
// through this and nothing else.
#pragma once
#include <fcntl.h>
#include <sys/stat.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace truestep {

/// An open file or folder.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;
  int get() const { return fd_; }
  /// The caller closes it.
  int release();

 private:
  int fd_;
};

class Place {
 public:
  /// Nowhere.
  Place() = default;
  /// The folder at a path, in which links are followed as in every path that a user gives. Error "folder_io".
  static Place folder(const std::string& path);
  explicit operator bool() const { return root_ != nullptr; }
  /// What has this name in this folder.
  Place operator/(std::string_view name) const;
  /// What has this name and an ending in the same folder.
  Place with_ending(std::string_view ending) const;
  Place parent() const;
  const std::string& name() const { return names_.back(); }

  /// Never waits for what is at the other end of a FIFO. Error "session_damaged" when it is missing and was
  /// to be read or is a link, otherwise "disk_full", "overloaded" or "folder_io" with `what` and its name.
  Descriptor open(int flags, const char* what) const;
  /// The same without errors: a negative descriptor says that it failed, and errno why.
  Descriptor try_open(int flags) const;
  /// As lstat; empty when there is none, or no way to it.
  std::optional<struct stat> status() const;
  /// Whether this is a file, and not a link to one.
  bool is_regular() const;
  /// The same; throws what open does when that cannot be found out.
  bool is_surely_regular() const;
  /// Names of what this folder holds; none when it is no folder.
  std::vector<std::string> names() const;

  /// No error if there is one. Error "disk_full" or "folder_io".
  void make_folder() const;
  /// errno; 0: done.
  int rename_to(const Place& other) const;
  /// The same for a file or a link; ENOENT when there is none.
  int remove() const;
  /// With everything in it, as far as that is possible.
  void remove_all() const;

  /// A path below the handle for libraries that want one. Its last name is theirs not to follow.
  std::string path() const;

 private:
  struct Way;
  Way way() const;
  std::shared_ptr<const Descriptor> root_;
  std::vector<std::string> names_;
};

/// A path to an open file, for libraries that want one.
std::string path_of(const Descriptor& file);

/// The error of a system call that failed with `code`: "disk_full", "overloaded" without descriptors, or
/// "folder_io".
[[noreturn]] void throw_file_error(const std::string& what, int code);

}  // namespace truestep
