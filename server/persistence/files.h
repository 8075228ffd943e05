// Files of the data folder: written as a whole or not at all, and errors that say what is full or unreadable.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "engine/session/sealed.h"

namespace truestep {

/// What a written file outlives: the end of the process (the system holds it), or a power cut as well.
enum class Durability : uint8_t { process, power };

/// A file that is written beside the one that it is to replace. Error "disk_full" or "folder_io".
class FreshFile {
 public:
  FreshFile(std::filesystem::path path, std::span<const std::byte> bytes, Durability durability);
  /// Removes what was written unless it has taken its place.
  ~FreshFile();
  FreshFile(const FreshFile&) = delete;
  FreshFile& operator=(const FreshFile&) = delete;
  /// Takes the place of the old file, at once.
  void commit();

 private:
  std::filesystem::path path_, fresh_;
  bool waits_ = true;
};

/// Replaces the file `path` at once. Error "disk_full" or "folder_io"; then the old file stands.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes, Durability durability);
/// For a file of a folder that nobody knows yet: as it is written.
void write_in_fresh_folder(const std::filesystem::path& path, std::span<const std::byte> bytes);
/// Makes what was written of a file, and its name, outlive a power cut.
void harden_file(const std::filesystem::path& path);
/// Makes all that was written on the folder's disk outlive a power cut, as far as the disk allows.
void sync_disk_of(const std::filesystem::path& folder);
/// The whole file. Error "folder_io" when it cannot be read, "session_damaged" when it is longer than `most`.
Bytes read_file(const std::filesystem::path& path, size_t most);
/// Its first bytes, at most so many.
Bytes read_head(const std::filesystem::path& path, size_t most);
/// Bytes of all files in a folder and those in it; 0 where there is none.
double folder_bytes(const std::filesystem::path& folder);
/// The error of a system call that failed with `code`.
[[noreturn]] void throw_file_error(const std::string& what, int code);

inline std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}
inline std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace truestep
