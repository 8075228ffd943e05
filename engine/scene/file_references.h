// References from a scene to files: {"asset": "<sha256>"} for files kept by a server, {"path": "part.stl"}
// for files next to a scene file, each optionally with "as" (FileUse) and "scale". The reference is replaced
// by the file's value, so that a session, its snapshots and its bundle hold everything they need.
#pragma once
#include <boost/json/value.hpp>
#include <filesystem>
#include <functional>
#include <string>

namespace truestep {

/// Replaces every reference of one kind; `key` is "asset" or "path". `fetch` returns the bytes for a name;
/// its Error "not_found" is reported at the reference. Error "scene_invalid" with a pointer to every fault,
/// "too_large" when the files together exceed 128 MiB.
void resolve_files(boost::json::value& document, std::string_view key,
                   const std::function<std::string(const std::string&)>& fetch);

/// Resolves paths: files in `folder` or below.
void resolve_paths(boost::json::value& document, const std::filesystem::path& folder);

}  // namespace truestep
