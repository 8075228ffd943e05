#include "engine/session/world/frame_builder.h"

#include <cstring>

#include "engine/base/errors.h"

namespace truestep {
namespace {

void copy_values(FrameBlock& block, const FieldView& view) {
  block.width = view.width;
  block.rows = view.rows;
  const size_t n = view.rows * view.width;
  block.data.resize(n * scalar_size(block.key.type));
  if (block.key.type == view.type) {
    if (n) std::memcpy(block.data.data(), view.data, n * scalar_size(view.type));
  } else if (block.key.type == Scalar::f32 && view.type == Scalar::f64) {
    const auto* from = static_cast<const double*>(view.data);
    auto* to = reinterpret_cast<float*>(block.data.data());
    for (size_t i = 0; i < n; ++i) to[i] = static_cast<float>(from[i]);
  } else {
    throw Error("bad_request", "this field cannot be sent as " + std::string(scalar_name(block.key.type)));
  }
}

}  // namespace

FramePtr FrameBuilder::build(const WorldState& state, double alpha, const FrameRequest& request) const {
  auto out = std::make_shared<Frame>();
  out->step = state.step;
  out->time = static_cast<double>(state.step) * world_->dt();
  out->alpha = alpha;
  if (request.wants(FrameRequest::Extras::state_hash)) out->state_hash = state.hash();
  out->drawing_version = world_->drawing_version(state);
  std::vector<double> scratch;
  for (const FieldKey& key : request.fields) {
    const PartTable::Entry& part = world_->parts()[key.part];
    FrameBlock& block = out->blocks.emplace_back();
    block.key = key;
    copy_values(block, part.field(state.systems[part.system], key.field, scratch));
  }
  if (wants(request.wishes, Wish::constant)) out->constant = constant(state, out->drawing_version);
  if (wants(request.wishes, Wish::obstacles | Wish::marks))
    world_->draw(state, without(request.wishes, Wish::constant), out->moving);
  if (request.wants(FrameRequest::Extras::observables)) out->observables = world_->observe(state);
  ++built_;
  return out;
}

std::shared_ptr<const Drawing> FrameBuilder::constant(const WorldState& state, uint32_t version) const {
  const std::lock_guard lock(mutex_);
  if (!drawing_ || version_ != version) {
    auto drawing = std::make_shared<Drawing>();
    world_->draw(state, Wish::constant, *drawing);
    drawing_ = std::move(drawing), version_ = version;
  }
  return drawing_;
}

}  // namespace truestep
