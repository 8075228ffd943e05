// Extensions of a glTF document: which of them change what is read here.
#pragma once
#include "engine/geometry/read/gltf/value.h"

namespace truestep::gltf {

/// A fault that names the extension if the file requires one that is neither read nor about looks alone.
void check_extensions(const Value& document);
/// The extension by which a primitive is compressed; empty without one.
std::string_view compression_of(const Value& primitive);

}  // namespace truestep::gltf
