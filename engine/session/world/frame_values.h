// A frame's fields as drawings read them: by part and meaning or name, element by element.
#pragma once
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "engine/session/world/frame.h"
#include "engine/session/world/part_table.h"

namespace truestep {

/// Rows of a field in a frame; no rows if the frame does not have it.
class FrameValues {
 public:
  FrameValues() = default;
  FrameValues(const Frame& frame, size_t part, std::optional<size_t> field) {
    for (const FrameBlock& b : frame.blocks) {
      if (field && b.key.part == part && b.key.field == *field) block_ = &b;
    }
  }
  size_t rows() const { return block_ ? block_->rows : 0; }
  uint32_t width() const { return block_ ? block_->width : 0; }
  bool has(size_t row, uint32_t width) const { return row < rows() && this->width() == width; }
  /// Element k of all rows concatenated.
  double at(size_t k) const {
    return element({block_->data.data(), block_->key.type, block_->rows, block_->width}, k);
  }
  std::vector<float> floats() const {
    std::vector<float> out(rows() * width());
    for (size_t k = 0; k < out.size(); ++k) out[k] = static_cast<float>(at(k));
    return out;
  }

 private:
  const FrameBlock* block_ = nullptr;
};

}  // namespace truestep
