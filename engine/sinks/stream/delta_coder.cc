#include "engine/sinks/stream/delta_coder.h"

#include <algorithm>

#include "engine/sinks/stream/block_encoding.h"
#include "engine/sinks/stream/difference_packing.h"

namespace truestep {

namespace {

bool is_delta(const WireField& field) {
  return field.encoding == WireEncoding::q16_delta;
}

void widen(ColumnBounds& a, const ColumnBounds& b) {
  for (size_t c = 0; c < std::min(a.low.size(), b.low.size()); ++c) {
    a.low[c] = std::min(a.low[c], b.low[c]);
    a.high[c] = std::max(a.high[c], b.high[c]);
  }
}

}  // namespace

EncodedBlocks DeltaCoder::encode(const FramePtr& frame, const QuantisedFramePtr& base) {
  if (frame.get() != frame_.get()) quantise_frame(frame);
  const QuantisedFramePtr usable = base && now_ && base->boxes == now_->boxes ? base : nullptr;
  for (const auto& [known, blocks] : encodings_) {
    if (known == usable) return blocks;
  }
  auto bytes = std::make_shared<std::string>();
  EncodedBlocks encoded{nullptr, now_, EncodedBlocks::Kind::key};
  std::string packed;
  size_t k = 0;
  for (const WireField& field : fields_) {
    const FrameBlock& block = block_of(*frame, field);
    if (!now_ || !is_delta(field)) {
      append_block(*bytes, field, block);
      continue;
    }
    const std::vector<uint16_t>& values = now_->values[k];
    const QuantumBox& box = (*now_->boxes)[k];
    packed.clear();
    if (usable) pack_differences(values, usable->values[k], packed);
    // Differences to an unrelated base may take more space than the values themselves.
    if (usable && packed.size() < 2 * values.size()) {
      append_block(*bytes, field, block, WireEncoding::q16_delta, box, packed);
      encoded.kind = EncodedBlocks::Kind::refers_to_base;
    } else {
      append_block(*bytes, field, block, WireEncoding::q16, box,
                   {reinterpret_cast<const char*>(values.data()), 2 * values.size()});
    }
    ++k;
  }
  encoded.bytes = std::move(bytes);
  encodings_.emplace_back(usable, encoded);
  return encoded;
}

void DeltaCoder::quantise_frame(const FramePtr& frame) {
  frame_ = frame;
  encodings_.clear();
  now_.reset();
  const bool old = ++frames_in_box_ > kBoxFrames;
  auto next = std::make_shared<QuantisedFrame>();
  if (old || !boxes_ || !fill(*frame, *next)) {
    if (!renew_boxes(*frame, boxes_ && !old)) return;
    fill(*frame, *next);
  }
  now_ = std::move(next);
}

bool DeltaCoder::fill(const Frame& frame, QuantisedFrame& into) const {
  into.boxes = boxes_;
  into.values.clear();
  for (const WireField& field : fields_) {
    if (!is_delta(field)) continue;
    const FrameBlock& block = block_of(frame, field);
    const QuantumBox& box = (*boxes_)[into.values.size()];
    std::vector<uint16_t>& values = into.values.emplace_back(block.rows * block.width);
    if (!quantise(floats_of(block), block.rows, block.width, box, values.data())) return false;
  }
  return true;
}

// With keep_seen the boxes also cover what earlier frames reached: oscillating values leave them only once.
bool DeltaCoder::renew_boxes(const Frame& frame, bool keep_seen) {
  std::vector<ColumnBounds> bounds;
  for (const WireField& field : fields_) {
    if (!is_delta(field)) continue;
    const FrameBlock& block = block_of(frame, field);
    if (!column_bounds(floats_of(block), block.rows, block.width, bounds.emplace_back())) {
      boxes_.reset();
      return false;
    }
    if (keep_seen) widen(bounds.back(), seen_[bounds.size() - 1]);
  }
  seen_ = std::move(bounds);
  auto boxes = std::make_shared<std::vector<QuantumBox>>();
  for (const ColumnBounds& b : seen_) boxes->push_back(roomy_box(b));
  boxes_ = std::move(boxes);
  frames_in_box_ = 0;
  return true;
}

}  // namespace truestep
