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

  /// All numbers of an accessor, row by row: integers as they are, or as fractions where it says
  /// `normalized`; zeros where it has no buffer view; its sparse values in their places.
  std::vector<double> numbers(const Value& reference, size_t width) const;
  std::vector<Vec3> vectors(const Value& reference) const;
  /// Whether the accessor has values in the file.
  bool has_data(const Value& reference) const;

 private:
  struct Buffer {
    std::vector<std::byte> bytes;
    std::string fault;  ///< why it has none
  };
  /// Rows of numbers within a buffer view.
  struct Rows {
    Value view;
    Value holder;   ///< of byteOffset
    int component;  ///< its type
    bool normalised;
    size_t columns, count;
    bool strided;
  };
  std::vector<double> read(const Rows& rows) const;
  void read_sparse(const Value& accessor, Rows rows, std::vector<double>& out) const;
  void spend(const Value& accessor, double numbers) const;

  Value document_;
  std::vector<Buffer> buffers_;
  mutable double spent_ = 0;  ///< numbers handed out
};

}  // namespace truestep::gltf
