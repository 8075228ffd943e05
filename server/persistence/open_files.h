// Files that are written often, by far more owners than there may be file descriptors: the most recently
// written stay open, the others are reopened when needed.
#pragma once
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>

namespace truestep {

class OpenFile {
 public:
  /// Opens for writing; creates the file if it is missing. Error "disk_full" or "folder_io".
  explicit OpenFile(const std::filesystem::path& path);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

class OpenFiles {
 public:
  explicit OpenFiles(size_t most = 32) : most_(most) {}
  /// The owner's file, which stays open at least while the pointer is held. Any thread.
  std::shared_ptr<OpenFile> open(const void* owner, const std::filesystem::path& path);
  void close(const void* owner);

 private:
  struct Kept {
    const void* owner;
    std::shared_ptr<OpenFile> file;
  };
  const size_t most_;
  std::mutex mutex_;
  std::list<Kept> files_;  ///< most recently used first
};

}  // namespace truestep
