// Where the command line reads scenes and binary files from.
#pragma once
#include <boost/json.hpp>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "engine/base/errors.h"

namespace truestep {

/// The scene document from a file, from standard input for "-", or from the gallery when no such file exists
/// and the name is a gallery scene's. References {"path": ...} are resolved relative to the scene file. Error
/// "not_found" or "bad_json".
boost::json::value load_scene_document(const std::string& path_or_name);

/// Reads a binary file. Error "not_found", or "too_large" beyond the largest snapshot or bundle.
std::vector<std::byte> load_bytes(const std::string& path);
/// Error "not_found" when the file cannot be written completely.
void save_bytes(const std::string& path, std::span<const std::byte> bytes);

/// "; did you mean "..."?" with the nearest name, or empty when none is near.
std::string did_you_mean(const std::string& name, std::span<const std::string> names);
/// The same with the names of the gallery.
std::string did_you_mean_scene(const std::string& name);

/// Error "not_found" (no such file, or a folder) unless `path` can be read.
void require_file(const std::string& path);

/// Prints one issue per line to stderr: pointer, message, allowed values.
void print_error(const Error& error);

}  // namespace truestep
