// Options for pictures: size, camera or side, and marks on bodies.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/sinks/picture/draw/draw_world.h"
#include "server/cli/arguments.h"

namespace truestep {

struct PictureSize {
  int width = 1280, height = 720;
};

struct PictureOptions {
  std::string size, camera, view, show, theme;
};

/// Adds --size, --camera, --view, --show and --theme, which are validated when read.
void add_picture_options(Arguments command, PictureOptions& options);

/// "1280x720". Error "bad_request".
PictureSize picture_size(const PictureOptions& options);
/// The theme, and whether contacts and joints are drawn on top of bodies.
PictureLook picture_look(const PictureOptions& options);
/// Sets the requested camera, or the side from which the list's own camera looks. Error "bad_request".
void aim(const PictureOptions& options, DrawList& list);

}  // namespace truestep
