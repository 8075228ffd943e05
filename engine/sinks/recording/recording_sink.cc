#include "engine/sinks/recording/recording_sink.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/scene/json/json_write.h"
#include "engine/session/commands.h"

namespace truestep {

namespace {

RecordingParams params_of(const World& world) {
  return world.scene().header.recording.value_or(RecordingParams{});
}

uint64_t last_step(const World& world) {
  return static_cast<uint64_t>(std::llround(world.scene().header.time.duration / world.dt()));
}

FieldKey key_of(const RecordedSource& source, size_t f, const RecordedPart& part) {
  const Precision p = part.fields[f].precision;
  const Scalar type = p == Precision::kU32 ? Scalar::u32 : p == Precision::kF64 ? Scalar::f64 : Scalar::f32;
  return {static_cast<uint32_t>(*source.part), static_cast<uint32_t>(source.fields[f]), type};
}

FieldValues values_of(const FrameBlock& b) {
  const size_t n = b.rows * b.width;
  switch (b.key.type) {
    case Scalar::f64:
      return std::span(reinterpret_cast<const double*>(b.data.data()), n);
    case Scalar::f32:
      return std::span(reinterpret_cast<const float*>(b.data.data()), n);
    default:
      return std::span(reinterpret_cast<const uint32_t*>(b.data.data()), n);
  }
}

}  // namespace

RecordingSink::RecordingSink(std::shared_ptr<RecordingThread> thread, const Session& session,
                             const std::string& path, RecordingTies ties)
    : RecordingSink(std::move(thread), session, plan_recording(session.world(), path), std::move(ties)) {}

RecordingSink::RecordingSink(std::shared_ptr<RecordingThread> thread, const Session& session,
                             PlannedRecording plan, RecordingTies ties)
    : session_(session),
      ties_(std::move(ties)),
      every_(static_cast<uint64_t>(params_of(session.world()).every)),
      first_step_(ties_.after ? *ties_.after + every_ : session.step_index()),
      last_step_(last_step(session.world())),
      sources_(std::move(plan.sources)),
      writer_(std::move(thread), std::move(plan.layout),
              ties_.after ? RecordingWriter::File::with_first_frames : RecordingWriter::File::at_once) {
  const RecordingLayout& layout = writer_.layout();
  request_.wishes = Wish::constant;
  for (size_t i = 0; i < sources_.size(); ++i) {
    gathered_.emplace_back(layout.parts[i].fields.size());
    if (!sources_[i].part) request_.wishes = request_.wishes | Wish::obstacles;
    for (size_t f = 0; f < sources_[i].fields.size(); ++f)
      request_.fields.push_back(key_of(sources_[i], f, layout.parts[i]));
  }
  std::sort(request_.fields.begin(), request_.fields.end());
  if (!layout.observables.empty()) request_.extras = FrameRequest::Extras::observables;
  if (!ties_.after) accept(session.frame(request_));
}

bool RecordingSink::goes_on(const World& world, uint64_t step) {
  return step + static_cast<uint64_t>(params_of(world).every) <= last_step(world);
}

std::optional<uint64_t> RecordingSink::durable_step() const {
  const uint64_t frames = writer_.durable_frames();
  return frames > 0 ? std::optional(first_step_ + (frames - 1) * every_) : ties_.after;
}

bool RecordingSink::due(uint64_t step) {
  return !finished_ && step >= first_step_ && (step - first_step_) % every_ == 0;
}

size_t RecordingSink::rows_of(const Frame& frame, size_t i, std::vector<FieldValues>& values) {
  const RecordedSource& source = sources_[i];
  size_t rows = 0;
  for (size_t f = 0; f < source.fields.size(); ++f) {
    const FrameBlock& b = *frame.find(key_of(source, f, writer_.layout().parts[i]));
    rows = b.rows / source.stride;
    if (source.stride == 1) {
      values.push_back(values_of(b));
      continue;
    }
    std::vector<double>& to = gathered_[i][f];
    to.clear();
    const FieldView view{b.data.data(), b.key.type, b.rows, b.width};
    for (size_t r = 0; r < rows; ++r) {
      for (uint32_t c = 0; c < b.width; ++c) to.push_back(element(view, r * source.stride * b.width + c));
    }
    values.emplace_back(std::span<const double>(to));
  }
  return rows;
}

size_t RecordingSink::obstacles_of(const Frame& frame, size_t i, std::vector<FieldValues>& values) {
  const size_t rows = writer_.layout().parts[i].max_rows;
  std::vector<double>&position = gathered_[i][0], &orientation = gathered_[i][1];
  position.assign(3 * rows, std::nan(""));
  orientation.assign(4 * rows, std::nan(""));
  for (size_t k = 0; k < std::min(rows, frame.moving.obstacles.size()); ++k) {
    const DrawnShape& o = frame.moving.obstacles[k];
    store3(position.data(), k, o.position);
    std::copy(o.orientation.begin(), o.orientation.end(), orientation.begin() + 4 * static_cast<int64_t>(k));
  }
  values = {std::span<const double>(position), std::span<const double>(orientation)};
  return rows;
}

void RecordingSink::accept(const FramePtr& frame) {
  std::vector<std::vector<FieldValues>> values(sources_.size());
  std::vector<PartRows> rows(sources_.size());
  for (size_t i = 0; i < sources_.size(); ++i) {
    rows[i].rows = sources_[i].part ? rows_of(*frame, i, values[i]) : obstacles_of(*frame, i, values[i]);
    rows[i].fields = values[i];
  }
  if (!first_look_) first_look_ = frame->constant, first_obstacles_ = frame->moving.obstacles;
  last_look_ = frame->constant;
  std::vector<double> observables;
  for (const RecordedObservable& o : writer_.layout().observables) {
    observables.push_back(frame->observables.find(o.name).value_or(std::nan("")));
  }
  writer_.append(static_cast<int64_t>(frame->step), frame->time, rows, observables);
  if (frame->step >= last_step_ && (ties_.after || frame->step > first_step_)) finish();
}

void RecordingSink::notify(std::string_view kind, uint64_t, const std::string&) {
  if (kind == "reset" || kind == "seek") finish();
}

RecordingStatus RecordingSink::finish() {
  RecordingStatus status = close();
  if (ties_.finished) std::exchange(ties_.finished, nullptr)(status);
  return status;
}

RecordingStatus RecordingSink::close() {
  finished_ = true;
  boost::json::array journal;
  for (const JournalEntry& e : session_.journal()) {
    journal.push_back(boost::json::object{
        {"step", e.step}, {"sequence", e.sequence}, {"command", write_command(e.command)}});
  }
  if (first_look_ == last_look_) return writer_.finalize(write_json(journal));
  // Bodies that appeared later have shapes, too; obstacles keep theirs.
  RecordedDrawing end = recorded_drawing(sources_, *last_look_, first_obstacles_);
  return writer_.finalize(write_json(journal), &end);
}

}  // namespace truestep
