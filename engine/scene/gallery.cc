#include "engine/scene/gallery.h"

namespace truestep {

const GalleryScene* find_gallery_scene(std::string_view name) {
  for (const GalleryScene& s : gallery()) {
    if (s.name == name) return &s;
  }
  return nullptr;
}

}  // namespace truestep
