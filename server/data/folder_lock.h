// The lock on a data folder: only one server at a time writes, repairs and removes its contents. It uses
// flock(2) on a file there, so it ends with its process however that dies; the file says who holds it.
#pragma once
#include <string>

namespace truestep {

class FolderLock {
 public:
  /// Locks nothing.
  FolderLock() = default;
  /// Locks an existing folder. Error "folder_locked" names the process, host and start time of the server
  /// that holds it; Error "folder_unusable" when no file can be written or locked there.
  explicit FolderLock(const std::string& folder);
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&& other) noexcept;
  ~FolderLock();

 private:
  int fd_ = -1;
};

}  // namespace truestep
