// Where the command line's scenes and files of bytes come from.
#pragma once
#include <boost/json.hpp>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "engine/base/errors.h"

namespace truestep {

/// The file's document, standard input for "-", or the gallery's scene when no such file exists and the name
/// is one of the gallery's. Error "not_found" or "bad_json".
boost::json::value load_scene_document(const std::string& path_or_name);

/// A file of bytes. Error "not_found", or "too_large" beyond what a snapshot or bundle may have.
std::vector<std::byte> load_bytes(const std::string& path);
/// Error "not_found" when the file cannot be written completely.
void save_bytes(const std::string& path, std::span<const std::byte> bytes);

/// One fault a line on stderr: pointer, message, allowed values.
void print_error(const Error& error);

}  // namespace truestep
