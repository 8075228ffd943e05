// A small file that somebody else may be writing: all of it as it was at one moment, or an error.
#pragma once
#include <string>

namespace truestep::net {

/// The bytes of a regular file. Never waits, whatever the path leads to. Error "bad_request", in which `what`
/// names the file, when it cannot be read, is no regular file, is longer than `most` bytes or changes
/// meanwhile.
std::string read_whole_file(const std::string& path, const std::string& what, size_t most);

}  // namespace truestep::net
