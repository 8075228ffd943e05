#include "engine/geometry/read/gltf/extensions.h"

#include <algorithm>

namespace truestep::gltf {

namespace {

/// They say how surfaces look, what lights them and what is known about them.
constexpr std::string_view kLooks[] = {
    "KHR_texture_",   "KHR_lights_",   "EXT_texture_",         "EXT_lights_",          "MSFT_texture_",
    "KHR_xmp",        "MSFT_packing_", "GOOGLE_texture_",      "KHR_techniques_webgl", "ADOBE_materials_",
    "EXT_materials_", "MSFT_lod",      "KHR_mesh_quantization"};
/// Of these, variants and all others are about looks as well.
constexpr std::string_view kMaterials = "KHR_materials_";
constexpr std::string_view kCompressed[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                            "KHR_meshopt_compression"};

}  // namespace

void check_extensions(const Value& document) {
  const Value required = document.member("extensionsRequired");
  for (size_t k = 0; k < required.size(); ++k) {
    const std::string name = required[k].text_or("");
    const auto begins = [&](std::string_view with) { return name.starts_with(with); };
    if (begins(kMaterials) || std::ranges::any_of(kLooks, begins)) continue;
    const bool compressed = std::ranges::find(kCompressed, name) != std::end(kCompressed);
    fail(required[k].where(), "the file requires " + name +
                                  (compressed ? ": compressed meshes are not read" : ", which is not read"));
  }
}

std::string_view compression_of(const Value& primitive) {
  if (!primitive.member("extensions").there()) return {};
  for (const std::string_view name : kCompressed) {
    if (primitive.member("extensions").member(name).there()) return name;
  }
  return {};
}

}  // namespace truestep::gltf
