// Where points have been: a scene whose viewer has a `trail` keeps the positions of its points, of up to 64
// in a system, some two hundred times in that time, and pictures draw them as lines that fade.
#pragma once
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "engine/session/world/frame.h"
#include "engine/session/world/world.h"
#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep {

class TrailSink final : public Sink {
 public:
  /// Null for a scene without trails.
  static std::shared_ptr<TrailSink> of(const World& world);

  bool due(uint64_t step) override { return step % every_ == 0; }
  const FrameRequest& request() const override { return request_; }
  void accept(const FramePtr& frame) override;
  void notify(std::string_view kind, uint64_t step, const std::string& detail) override;

  /// Appends the trails of part p up to `frame`, which end at `now`: the positions of its rows.
  void add_to(DrawList& list, size_t p, const Frame& frame, const std::vector<float>& now,
              const std::optional<Color>& color) const;

 private:
  TrailSink(const World& world, double seconds);

  /// Positions of each part of the request at a step.
  struct Sample {
    uint64_t step = 0;
    std::vector<std::vector<float>> positions;
  };

  FrameRequest request_;
  uint64_t every_ = 1, reach_ = 0;  ///< steps
  mutable std::mutex mutex_;
  std::deque<Sample> samples_;
};

}  // namespace truestep
