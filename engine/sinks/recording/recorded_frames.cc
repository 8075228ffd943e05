#include "engine/sinks/recording/recorded_frames.h"

#include <algorithm>
#include <cstring>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "engine/sinks/recording/recorded_drawing.h"

namespace truestep {

namespace {

std::unique_ptr<const World> world_of(const RecordingLayout& layout) {
  boost::json::value scene = parse_json(layout.scene_json);
  // Nothing is stepped, so nothing has to be measured.
  if (scene.is_object()) scene.as_object().erase("accuracy");
  return std::make_unique<const World>(require_scene(read_scene(scene)));
}

}  // namespace

RecordedFrames::RecordedFrames(RecordingReader& reader)
    : reader_(reader), world_(world_of(reader.info().layout)) {
  const RecordingInfo& info = reader.info();
  if (info.frames == 0) throw Error("recording_foreign", "the recording has no frames");
  auto drawing = std::make_shared<Drawing>();
  const WorldState start = world_->initial_state();
  world_->draw(start, Wish::constant, *drawing);
  for (size_t s = 0; s < info.layout.parts.size(); ++s) {
    const RecordedPart& part = info.layout.parts[s];
    const auto is = [&](const PartTable::Entry& e) { return e.id == part.id; };
    const auto at = std::find_if(world_->parts().begin(), world_->parts().end(), is);
    if (at == world_->parts().end() && part.type != "obstacles")
      throw Error("recording_foreign", "the recorded scene has no part " + part.id);
    parts_.push_back(at == world_->parts().end() ? std::nullopt
                                                 : std::optional<size_t>(at - world_->parts().begin()));
    if (!parts_.back()) continue;
    // Bodies that appeared later are only in the recording.
    PartDrawing& look = drawing->parts[*parts_.back()];
    if (s < info.layout.drawing.parts.size() &&
        info.layout.drawing.parts[s].instances.size() != 2 * look.instances.size())
      restore_shapes(info.layout.drawing, s, look);
  }
  constant_ = std::move(drawing);
  Drawing moving;
  world_->draw(start, Wish::obstacles, moving);
  obstacles_ = std::move(moving.obstacles);
  if (info.frames > 1)
    every_ =
        std::max<uint64_t>(1, static_cast<uint64_t>(reader.read_clock(1).step - reader.read_clock(0).step));
}

// Frames that a film has passed are forgotten.
const std::vector<double>& RecordedFrames::trail_values(uint64_t index, size_t part, size_t field) {
  const auto [at, fresh] = earlier_.try_emplace({part, index});
  if (fresh) reader_.read_field(index, part, field, at->second);
  return at->second;
}

FrameBlock RecordedFrames::block(uint64_t index, size_t part, size_t field) {
  const RecordedField& recorded = reader_.info().layout.parts[part].fields[field];
  const PartInfo& info = world_->parts()[*parts_[part]].info();
  FrameBlock out;
  out.key = {static_cast<uint32_t>(*parts_[part]),
             static_cast<uint32_t>(info.find(recorded.name).value_or(0)), Scalar::f64};
  out.width = recorded.width;
  std::vector<double> values;
  if (info.trail == 0) {
    reader_.read_field(index, part, field, values);
  } else {
    const size_t bodies = trail_values(index, part, field).size() / recorded.width;
    const uint64_t reach = info.trail / every_;
    const auto first = earlier_.lower_bound({part, 0});
    earlier_.erase(first, earlier_.lower_bound({part, index > reach ? index - reach : 0}));
    for (size_t b = 0; b < bodies; ++b) {
      for (size_t k = 0; k <= info.trail; ++k) {
        const uint64_t back = std::min<uint64_t>(k / every_, index);
        const auto& at = trail_values(index - back, part, field);
        const auto from = at.begin() + static_cast<std::ptrdiff_t>(b * recorded.width);
        values.insert(values.end(), from, from + recorded.width);
      }
    }
  }
  out.rows = values.size() / std::max<uint32_t>(1, recorded.width);
  out.data.resize(values.size() * sizeof(double));
  if (!values.empty()) std::memcpy(out.data.data(), values.data(), out.data.size());
  return out;
}

void RecordedFrames::add_obstacles(uint64_t index, size_t part, Frame& out) {
  std::vector<double> position, orientation;
  reader_.read_field(index, part, 0, position);
  reader_.read_field(index, part, 1, orientation);
  for (size_t k = 0; k < std::min(obstacles_.size(), position.size() / 3); ++k) {
    DrawnShape& o = out.moving.obstacles[k];
    o.position = {position[3 * k], position[3 * k + 1], position[3 * k + 2]};
    for (size_t c = 0; c < 4 && 4 * k + c < orientation.size(); ++c)
      o.orientation[c] = orientation[4 * k + c];
  }
}

FramePtr RecordedFrames::frame(uint64_t index) {
  auto out = std::make_shared<Frame>();
  const RecordedClock clock = reader_.read_clock(index);
  out->step = static_cast<uint64_t>(clock.step);
  out->time = clock.time;
  out->constant = constant_;
  out->moving.obstacles = obstacles_;
  for (size_t s = 0; s < parts_.size(); ++s) {
    const RecordedPart& part = reader_.info().layout.parts[s];
    if (!parts_[s]) {
      add_obstacles(index, s, *out);
      continue;
    }
    for (size_t f = 0; f < part.fields.size(); ++f) out->blocks.push_back(block(index, s, f));
  }
  return out;
}

}  // namespace truestep
