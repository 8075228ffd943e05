// Where rendered pictures go: numbered PNG files, or a film that ffmpeg makes of them.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "server/cli/picture_options.h"

namespace truestep {

class PictureFiles {
 public:
  virtual ~PictureFiles() = default;
  /// The next picture: height x width x 4 bytes, top row first. Error "write_failed".
  virtual void add(std::span<const uint8_t> rgba) = 0;
  /// All pictures are there. Error "write_failed".
  virtual void finish() = 0;
  /// Files that were written, for people.
  virtual std::string summary() const = 0;
};

/// Pictures as `path` says: x.png makes x.000000.png, x.000001.png ...; x.mp4 and x.gif need ffmpeg, which is
/// looked for at once. Missing folders are made. Error "bad_request" for another ending, "not_found" without
/// ffmpeg.
std::unique_ptr<PictureFiles> open_pictures(const std::string& path, PictureSize size, double per_second);

/// Makes the folders that a file needs. Error "write_failed".
void make_folder_of(const std::string& file);

/// One PNG file, with the folders that it needs. Error "write_failed".
void write_png(const std::string& path, std::span<const uint8_t> rgba, PictureSize size);

}  // namespace truestep
