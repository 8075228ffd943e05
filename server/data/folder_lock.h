// The lock on a data folder: only one server at a time writes, repairs and removes its contents. It uses
// flock(2) on the folder and on a file there, so it ends with its process however that dies. The file says
// who holds it, and locks where folders cannot be locked (NFS); without it the folder is locked all the same.
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

  /// Why nothing that is written below the folder's path is kept: it was removed, or is another one by now.
  /// Empty: all is well.
  std::string problem() const;

 private:
  void let_go();
  std::string folder_;
  int folder_fd_ = -1, fd_ = -1;
};

}  // namespace truestep
