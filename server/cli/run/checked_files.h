// The scene files that `truestep check` is given, and the runs that they ask for, made on all cores.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/errors.h"
#include "engine/studies/check/scene_check.h"

namespace truestep {

/// A file with what came of it: a check, or the error why there is none.
struct CheckedFile {
  std::string path;
  std::unique_ptr<SceneCheck> check;
  std::optional<Error> error;
  double cpu_seconds = 0;
};

/// The files named, and every *.json in and below the folders, in order. Error "not_found".
std::vector<std::string> scene_files(const std::vector<std::string>& paths);

/// Reads a file. "scene": NAME in it stands for the gallery scene or the file (relative to this one) of that
/// name, changed by the rest as by a JSON merge patch.
CheckedFile read_checked(const std::string& path);

/// Makes all runs by so many threads, those that are estimated to take longest first. Stops early, with the
/// remaining runs not made, when interrupted; returns whether all were made.
bool run_all(std::vector<CheckedFile>& files, int threads);

}  // namespace truestep
