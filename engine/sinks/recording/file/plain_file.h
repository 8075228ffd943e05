// Files written by plain system calls: errors are seen where they happen, and no library is left in the midst
// of something.
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace truestep {

/// The error of a system call of a recording that failed with `code`: Error "disk_full", "overloaded" or
/// "recording_io".
[[noreturn]] void throw_recording_error(const std::string& what, int code);
/// Opens a file that is no link, and waits for nothing; -1 with errno. What belongs to a recording is where
/// its writer put it: a link in its place was put there by somebody else.
int open_plainly(const std::string& path, int flags);
/// All of such a file; none when it cannot be read or is no file.
std::optional<std::vector<std::byte>> read_plainly(const std::string& path);
/// Writes all of it. Errors as above.
void write_plainly(int fd, std::span<const std::byte> bytes, const std::string& what);
/// Replaces the file by these bytes. Errors as above.
void create_plainly(const std::string& path, std::span<const std::byte> bytes, const std::string& what);

}  // namespace truestep
