#include "engine/sinks/picture/draw/trails.h"

#include <algorithm>
#include <cmath>

#include "engine/session/world/frame_values.h"
#include "engine/sinks/picture/color_map.h"

namespace truestep {

namespace {

constexpr size_t kMostRows = 64;               // of a part with trails
constexpr double kSamples = 200;               // of a trail
constexpr int kShades = 5;                     // from the oldest to the newest
constexpr double kTrailPixels = 2;             // width
constexpr float kLeast = 0.15f, kMost = 0.8f;  // how much of its colour is left

}  // namespace

std::shared_ptr<TrailSink> TrailSink::of(const World& world) {
  const auto& trail = world.scene().header.viewer.trail;
  return trail ? std::shared_ptr<TrailSink>(new TrailSink(world, *trail)) : nullptr;
}

TrailSink::TrailSink(const World& world, double seconds)
    : every_(static_cast<uint64_t>(std::clamp(std::round(seconds / world.dt() / kSamples), 1.0, 1e15))),
      reach_(static_cast<uint64_t>(std::clamp(std::ceil(seconds / world.dt()), 1.0, 1e18))) {
  for (size_t p = 0; p < world.parts().size(); ++p) {
    const PartInfo& info = world.parts()[p].info();
    const auto position = info.find(Meaning::position);
    if (info.kind != PartInfo::Kind::points || info.max_rows > kMostRows || !position) continue;
    request_.fields.push_back({static_cast<uint32_t>(p), static_cast<uint32_t>(*position), Scalar::f32});
  }
}

void TrailSink::accept(const FramePtr& frame) {
  Sample sample{frame->step, {}};
  for (const FieldKey& key : request_.fields)
    sample.positions.push_back(FrameValues(*frame, key.part, key.field).floats());
  const std::lock_guard lock(mutex_);
  samples_.push_back(std::move(sample));
  while (samples_.front().step + reach_ < frame->step) samples_.pop_front();
}

void TrailSink::notify(std::string_view kind, uint64_t step, const std::string&) {
  if (kind != "reset" && kind != "seek") return;
  const std::lock_guard lock(mutex_);
  while (!samples_.empty() && samples_.back().step > step) samples_.pop_back();
}

void TrailSink::add_to(DrawList& list, size_t p, const Frame& frame, const std::vector<float>& now,
                       const std::optional<Color>& color) const {
  const auto key = std::find_if(request_.fields.begin(), request_.fields.end(),
                                [&](const FieldKey& k) { return k.part == p; });
  if (key == request_.fields.end()) return;
  std::vector<std::vector<float>> past;
  {
    const std::lock_guard lock(mutex_);
    for (const Sample& sample : samples_) {
      if (sample.step >= frame.step || sample.step + reach_ < frame.step) continue;
      past.push_back(sample.positions[static_cast<size_t>(key - request_.fields.begin())]);
      // A row that comes or goes leaves no telling which is which.
      if (past.back().size() != now.size()) past.clear();
    }
  }
  past.push_back(now);
  if (past.size() < 2) return;
  const Color ink = color.value_or(picture::ink_over(list.background_bottom));
  for (int shade = 0; shade < kShades; ++shade) {
    const size_t from = (past.size() - 1) * static_cast<size_t>(shade) / kShades,
                 to = (past.size() - 1) * static_cast<size_t>(shade + 1) / kShades;
    if (from == to) continue;
    DrawPoints& set = list.points.emplace_back();
    const float share = kLeast + (kMost - kLeast) * static_cast<float>(shade + 1) / kShades;
    set.color = mixed(list.background_bottom, ink, share);
    set.line_color = set.color;
    set.line_pixels = kTrailPixels;
    for (size_t row = 0; row < now.size() / 3; ++row) {
      for (size_t k = from; k <= to; ++k) {
        const auto at = static_cast<uint32_t>(set.positions.size() / 3);
        set.positions.insert(set.positions.end(), &past[k][3 * row], &past[k][3 * row] + 3);
        if (k > from) set.lines.insert(set.lines.end(), {at - 1, at});
      }
    }
  }
}

}  // namespace truestep
