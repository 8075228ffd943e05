// Where rendered pictures go: numbered PNG files, or a film made by ffmpeg.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "server/cli/pictures/picture_options.h"

namespace truestep {

class PictureFiles {
 public:
  virtual ~PictureFiles() = default;
  /// Adds a picture: height x width x 4 bytes, top row first. Error "write_failed".
  virtual void add(std::span<const uint8_t> rgba) = 0;
  /// No more pictures follow. Error "write_failed".
  virtual void finish() = 0;
  /// The files written, in words.
  virtual std::string summary() const = 0;
};

/// Output according to `path`: x.png gives x.000000.png, x.000001.png ...; x.mp4 and x.gif need ffmpeg, which
/// is looked up at once. Creates missing folders. Error "bad_request" for any other ending, "not_found"
/// without ffmpeg.
std::unique_ptr<PictureFiles> open_pictures(const std::string& path, PictureSize size, double per_second);

/// Creates the folders for a file. Error "write_failed".
void make_folder_of(const std::string& file);

/// Writes one PNG file and creates its folders. Error "write_failed".
void write_png(const std::string& path, std::span<const uint8_t> rgba, PictureSize size);

}  // namespace truestep
