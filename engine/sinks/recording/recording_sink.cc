#include "engine/sinks/recording/recording_sink.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/version.h"
#include "engine/scene/json_write.h"
#include "engine/session/commands.h"

namespace truestep {

namespace {

RecordingParams params_of(const World& world) {
  return world.scene().header.recording.value_or(RecordingParams{});
}

uint64_t last_step(const World& world) {
  return static_cast<uint64_t>(std::llround(world.scene().header.time.duration / world.dt()));
}

[[noreturn]] void refuse(size_t index, const std::string& message) {
  throw Error("scene_invalid", message,
              {{"/recording/fields/" + std::to_string(index), "unknown_field", message, "", "", "", ""}});
}

// Observables that a recording keeps: those that the scene names, all where it names none.
bool wants_observable(const Scene& scene, std::string_view name) {
  const auto& wanted = scene.header.observables;
  return wanted.empty() ||
         std::any_of(wanted.begin(), wanted.end(), [&](const std::string& w) { return selects(w, name); });
}

// Fields to record of a part: those named, else the places of points, all of a grid, and what is computed of
// a system that is numbers alone.
std::vector<size_t> wanted_fields(const PartInfo& part, const RecordingParams& params) {
  std::vector<size_t> out;
  for (size_t f = 0; f < part.fields.size(); ++f) {
    const FieldInfo& field = part.fields[f];
    const bool named =
        std::find(params.fields.begin(), params.fields.end(), field.name) != params.fields.end();
    const bool usual = part.kind == PartInfo::Kind::points ? field.meaning == Meaning::position
                       : part.kind == PartInfo::Kind::grid ? true
                                                           : part.name.empty();
    if (params.fields.empty() ? usual : named) out.push_back(f);
  }
  return out;
}

std::optional<Precision> precision_of(Scalar type, RecordingParams::Precision wanted) {
  if (type == Scalar::u32) return Precision::kU32;
  if (type != Scalar::f64 && type != Scalar::f32) return std::nullopt;
  return wanted == RecordingParams::Precision::f64 && type == Scalar::f64 ? Precision::kF64 : Precision::kF32;
}

}  // namespace

RecordingLayout recording_layout(const World& world, const std::string& path) {
  const RecordingParams params = params_of(world);
  RecordingLayout layout;
  layout.path = path;
  layout.scene_json = write_json(world.scene().canonical());
  layout.seed = world.scene().header.seed;
  layout.dt = world.dt();
  layout.build = std::string(version()) + ' ' + std::string(build_description());
  const WorldState state = world.initial_state();
  Drawing drawing;
  world.draw(state, Wish::constant, drawing);
  std::vector<double> scratch;
  for (size_t p = 0; p < world.parts().size(); ++p) {
    const PartTable::Entry& part = world.parts()[p];
    RecordedPart s;
    s.id = part.id;
    s.type = world.scene().systems[part.system].row->type;
    s.kind = part.info().kind;
    s.lattice = part.info().lattice;
    s.max_rows = static_cast<uint32_t>(part.info().max_rows);
    for (const size_t f : wanted_fields(part.info(), params)) {
      const FieldInfo& info = part.info().fields[f];
      const auto precision = precision_of(info.type, params.precision);
      if (!precision) continue;
      s.fields.push_back({info.name, info.unit, info.width, *precision, info.meaning});
      const size_t rows = part.field(state.systems[part.system], f, scratch).rows;
      s.max_rows = std::max(s.max_rows, static_cast<uint32_t>(rows));
      if (rows != s.max_rows) s.rows = RowPolicy::kVariable;
    }
    if (s.fields.empty()) continue;
    for (const auto& l : drawing.parts[p].lines) s.lines.insert(s.lines.end(), l.begin(), l.end());
    for (const auto& t : drawing.parts[p].triangles)
      s.triangles.insert(s.triangles.end(), t.begin(), t.end());
    layout.parts.push_back(std::move(s));
  }
  for (size_t k = 0; k < params.fields.size(); ++k) {
    bool found = false;
    for (const RecordedPart& s : layout.parts) {
      for (const RecordedField& f : s.fields) found |= f.name == params.fields[k];
    }
    if (!found) refuse(k, "no system has a field \"" + params.fields[k] + "\" that can be recorded");
  }
  for (const Observation& o : world.known_observables()) {
    if (wants_observable(world.scene(), o.name)) layout.observables.push_back({o.name, o.unit});
  }
  return layout;
}

RecordingSink::RecordingSink(std::shared_ptr<RecordingThread> thread, const Session& session,
                             const std::string& path, RecordingTies ties)
    : session_(session),
      ties_(std::move(ties)),
      every_(static_cast<uint64_t>(params_of(session.world()).every)),
      first_step_(ties_.after ? *ties_.after + every_ : session.step_index()),
      last_step_(last_step(session.world())),
      writer_(std::move(thread), recording_layout(session.world(), path),
              ties_.after ? RecordingWriter::File::with_first_frames : RecordingWriter::File::at_once) {
  const PartTable& parts = session.world().parts();
  for (const RecordedPart& s : writer_.layout().parts) {
    size_t p = 0;
    while (parts[p].id != s.id) ++p;
    auto& keys = keys_.emplace_back();
    for (const RecordedField& f : s.fields) {
      const Scalar type = f.precision == Precision::kU32   ? Scalar::u32
                          : f.precision == Precision::kF64 ? Scalar::f64
                                                           : Scalar::f32;
      keys.push_back({static_cast<uint32_t>(p), static_cast<uint32_t>(*parts[p].info().find(f.name)), type});
      request_.fields.push_back(keys.back());
    }
  }
  std::sort(request_.fields.begin(), request_.fields.end());
  if (!writer_.layout().observables.empty()) request_.extras = FrameRequest::Extras::observables;
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

void RecordingSink::accept(const FramePtr& frame) {
  std::vector<std::vector<FieldValues>> values(keys_.size());
  std::vector<PartRows> rows(keys_.size());
  for (size_t i = 0; i < keys_.size(); ++i) {
    for (const FieldKey& key : keys_[i]) {
      const FrameBlock& b = *frame->find(key);
      const size_t n = b.rows * b.width;
      rows[i].rows = b.rows;
      switch (key.type) {
        case Scalar::f64:
          values[i].emplace_back(std::span(reinterpret_cast<const double*>(b.data.data()), n));
          break;
        case Scalar::f32:
          values[i].emplace_back(std::span(reinterpret_cast<const float*>(b.data.data()), n));
          break;
        default:
          values[i].emplace_back(std::span(reinterpret_cast<const uint32_t*>(b.data.data()), n));
          break;
      }
    }
    rows[i].fields = values[i];
  }
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
  const RecordingStatus status = close();
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
  return writer_.finalize(write_json(journal));
}

}  // namespace truestep
