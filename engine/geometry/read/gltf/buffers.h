// The buffers of a glTF document, and the numbers that accessors refer to.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/geometry/read/gltf/value.h"

namespace truestep::gltf {

/// Decodes base64, ignoring white space; faults are reported at `where`.
std::vector<std::byte> from_base64(std::string_view text, const std::string& where);

class Buffers {
 public:
  /// `binary`: the contents of the first buffer when it has no URI.
  Buffers(const Value& document, std::span<const std::byte> binary);

  /// All numbers of an accessor, row by row; `width` 0 accepts any width.
  std::vector<double> numbers(const Value& reference, size_t width, bool normalised_integers) const;
  std::vector<Vec3> vectors(const Value& reference) const;

 private:
  Value document_;
  std::vector<std::vector<std::byte>> buffers_;
};

}  // namespace truestep::gltf
