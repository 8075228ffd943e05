// Where the command line's scenes come from.
#pragma once
#include <boost/json.hpp>
#include <string>

#include "engine/base/errors.h"

namespace truestep {

/// The file's document, standard input for "-", or the gallery's scene when no such file exists and the name
/// is one of the gallery's. Error "not_found" or "bad_json".
boost::json::value load_scene_document(const std::string& path_or_name);

/// One fault a line on stderr: pointer, message, allowed values.
void print_error(const Error& error);

}  // namespace truestep
