// Files written by plain system calls: errors are seen where they happen, and no library is left in the midst
// of something.
#pragma once
#include <cstddef>
#include <span>
#include <string>

namespace truestep {

/// The error of a system call of a recording that failed with `code`: Error "disk_full", "overloaded" or
/// "recording_io".
[[noreturn]] void throw_recording_error(const std::string& what, int code);
/// Writes all of it. Errors as above.
void write_plainly(int fd, std::span<const std::byte> bytes, const std::string& what);
/// Replaces the file by these bytes. Errors as above.
void create_plainly(const std::string& path, std::span<const std::byte> bytes, const std::string& what);

}  // namespace truestep
