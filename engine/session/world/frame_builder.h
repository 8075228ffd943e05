// The one way from a state to what is shown of it: frames with the fields, drawings and numbers that a sink
// asked for. The constant part of a drawing is built when its version changes and shared by all frames until
// then.
#pragma once
#include <atomic>
#include <memory>
#include <mutex>

#include "engine/session/world/frame.h"
#include "engine/session/world/world.h"

namespace truestep {

class FrameBuilder {
 public:
  explicit FrameBuilder(std::shared_ptr<const World> world) : world_(std::move(world)) {}

  /// A frame of a state of the world. Error "bad_request" for a field that does not exist in the wanted type.
  FramePtr build(const WorldState& state, double alpha, const FrameRequest& request) const;
  /// Frames built so far; a frame that nobody asked for is not built.
  uint64_t built() const { return built_; }

 private:
  std::shared_ptr<const Drawing> constant(const WorldState& state, uint32_t version) const;

  std::shared_ptr<const World> world_;
  mutable std::atomic<uint64_t> built_{0};
  mutable std::mutex mutex_;
  mutable uint32_t version_ = 0;
  mutable std::shared_ptr<const Drawing> drawing_;  ///< of `version_`
};

}  // namespace truestep
