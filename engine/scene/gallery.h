// The scenes of the folder scenes/, linked into the program.
#pragma once
#include <span>
#include <string_view>

namespace truestep {

struct GalleryScene {
  std::string_view name;  ///< file name without .json
  std::string_view text;  ///< the document
};

/// All scenes, ordered by name.
std::span<const GalleryScene> gallery();
/// The scene of that name, or null.
const GalleryScene* find_gallery_scene(std::string_view name);

}  // namespace truestep
