// Files of the data folder: written completely or not at all, with errors that say what is full or
// unreadable.
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "engine/session/snapshot/sealed.h"
#include "server/persistence/place.h"

namespace truestep {

/// What a written file survives: the end of the process (the operating system has it), or a power cut as
/// well.
enum class Durability : uint8_t { process, power };

/// A new version of a file, written next to the one it will replace. Error "disk_full" or "folder_io".
class FreshFile {
 public:
  FreshFile(const Place& place, std::span<const std::byte> bytes, Durability durability);
  /// Removes the new file unless it has been committed.
  ~FreshFile();
  FreshFile(const FreshFile&) = delete;
  FreshFile& operator=(const FreshFile&) = delete;
  /// Replaces the old file atomically.
  void commit();

 private:
  const Place place_, fresh_;
  bool waits_ = true;
};

/// Replaces the file atomically. Error "disk_full" or "folder_io"; then the old file remains.
void write_file(const Place& place, std::span<const std::byte> bytes, Durability durability);
/// For a file in a folder that is not published yet: written in place.
void write_in_fresh_folder(const Place& place, std::span<const std::byte> bytes);
/// Makes the contents and the name of a file survive a power cut.
void harden_file(const Place& place);
/// Makes everything written to the folder's disk survive a power cut, as far as the disk allows.
void sync_disk_of(const Place& folder);
/// The whole file. Error "folder_io" when it cannot be read, "session_damaged" when it is longer than `most`.
Bytes read_file(const Place& place, size_t most);
/// The first bytes of a file, at most this many.
Bytes read_head(const Place& place, size_t most);
/// Bytes of all files in a folder, recursively; 0 when there is none.
double folder_bytes(const Place& folder);

inline std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}
inline std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace truestep
