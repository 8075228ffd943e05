// How pictures of the command line look: size, camera or side, and marks over bodies.
#pragma once
#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/sinks/picture/draw_world.h"

namespace truestep {

struct PictureSize {
  int width = 1280, height = 720;
};

struct PictureOptions {
  std::string size, camera, view, show, theme;
};

/// Adds --size, --camera, --view, --show and --theme, which are checked when they are read.
void add_picture_options(CLI::App& command, PictureOptions& options);

/// "1280x720". Error "bad_request".
PictureSize picture_size(const PictureOptions& options);
/// The theme, and the contacts and joints that are shown over bodies.
PictureLook picture_look(const PictureOptions& options);
/// Sets the camera that was asked for, or the side that a camera of the list's own choice looks from. Error
/// "bad_request".
void aim(const PictureOptions& options, DrawList& list);

}  // namespace truestep
