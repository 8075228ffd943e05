// One folder for the files of a fuzz target, in memory if possible, for the lifetime of the process.
#pragma once
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace truestep::fuzz {

inline const std::filesystem::path& scratch_folder() {
  namespace fs = std::filesystem;
  static const fs::path kFolder = [] {
    const fs::path base = fs::is_directory("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
    const fs::path path = base / ("truestep_fuzz_" + std::to_string(getpid()));
    fs::create_directory(path);
    std::atexit([] { fs::remove_all(scratch_folder()); });
    return path;
  }();
  return kFolder;
}

}  // namespace truestep::fuzz
