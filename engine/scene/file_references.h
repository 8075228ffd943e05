// References of a scene to files: {"asset": "<sha256>"} of what a server keeps, {"path": "part.stl"} of what
// lies beside a scene file, each with "as" (FileUse) and "scale" where it wants them. The file's value takes
// the reference's place, so that a session, its snapshots and its bundle hold all they need.
#pragma once
#include <boost/json/value.hpp>
#include <filesystem>
#include <functional>
#include <string>

namespace truestep {

/// Replaces every reference of a kind, `key` being "asset" or "path". `fetch` gives the bytes of a name;
/// an Error "not_found" of it becomes the reference's. Error "scene_invalid" with a pointer to all that is
/// wrong, "too_large" where the files together are larger than 128 MiB.
void resolve_files(boost::json::value& document, std::string_view key,
                   const std::function<std::string(const std::string&)>& fetch);

/// References to paths: files in `folder` or below.
void resolve_paths(boost::json::value& document, const std::filesystem::path& folder);

}  // namespace truestep
