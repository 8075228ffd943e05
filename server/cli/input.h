// Where the command line's scenes and files of bytes come from.
#pragma once
#include <boost/json.hpp>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "engine/base/errors.h"

namespace truestep {

/// Files that the document refers to by {"path": ...} from the scene file's folder are put in. The file's
/// document, standard input for "-", or the gallery's scene when no such file exists and the name
/// is one of the gallery's. Error "not_found" or "bad_json".
boost::json::value load_scene_document(const std::string& path_or_name);

/// A file of bytes. Error "not_found", or "too_large" beyond what a snapshot or bundle may have.
std::vector<std::byte> load_bytes(const std::string& path);
/// Error "not_found" when the file cannot be written completely.
void save_bytes(const std::string& path, std::span<const std::byte> bytes);

/// "; did you mean "..."?" with the nearest of the names, or nothing when none is near.
std::string did_you_mean(const std::string& name, std::span<const std::string> names);
/// The same with the names of the gallery.
std::string did_you_mean_scene(const std::string& name);

/// Error "not_found" (no such file, or a folder) unless `path` can be read.
void require_file(const std::string& path);

/// One fault a line on stderr: pointer, message, allowed values.
void print_error(const Error& error);

}  // namespace truestep
