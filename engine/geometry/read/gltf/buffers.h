// The buffers of a glTF document and the numbers that its accessors find in them.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/geometry/read/gltf/value.h"

namespace truestep::gltf {

/// Bytes of a text in base64, white space left out; faults say `where`.
std::vector<std::byte> from_base64(std::string_view text, const std::string& where);

class Buffers {
 public:
  /// `binary`: what the first buffer holds when it names no URI.
  Buffers(const Value& document, std::span<const std::byte> binary);

  /// All numbers of an accessor, row by row; `width` 0: any.
  std::vector<double> numbers(const Value& reference, size_t width, bool normalised_integers) const;
  std::vector<Vec3> vectors(const Value& reference) const;

 private:
  Value document_;
  std::vector<std::vector<std::byte>> buffers_;
};

}  // namespace truestep::gltf
