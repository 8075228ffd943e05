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

std::optional<size_t> field_index(const System& system, const std::string& name) {
  const auto infos = system.fields();
  for (size_t f = 0; f < infos.size(); ++f) {
    if (infos[f].name == name) return f;
  }
  return std::nullopt;
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

// Fields to record of a system: those named, else position, else all that are as long as the first.
std::vector<std::string> wanted_fields(const System& system, const State& state,
                                       const RecordingParams& params) {
  if (!params.fields.empty()) return params.fields;
  if (field_index(system, "position")) return {"position"};
  std::vector<std::string> all;
  const auto infos = system.fields();
  std::vector<double> scratch;
  const size_t rows = infos.empty() ? 0 : system.field(state, 0, scratch).rows;
  for (size_t f = 0; f < infos.size(); ++f) {
    if (system.field(state, f, scratch).rows == rows) all.push_back(infos[f].name);
  }
  return all;
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
  for (size_t i = 0; i < world.size(); ++i) {
    const System& system = world.system(i);
    RecordedSystem s;
    s.id = world.id(i);
    s.type = world.scene().systems[i].row->type;
    s.max_rows = static_cast<uint32_t>(system.max_rows());
    std::vector<double> scratch;
    for (const std::string& name : wanted_fields(system, state.systems[i], params)) {
      const auto f = field_index(system, name);
      if (!f) continue;
      const FieldInfo info = system.fields()[*f];
      if (info.type != Scalar::f64 && info.type != Scalar::f32 && info.type != Scalar::u32) continue;
      const Precision precision =
          info.type == Scalar::u32                                                          ? Precision::kU32
          : params.precision == RecordingParams::Precision::f64 && info.type == Scalar::f64 ? Precision::kF64
                                                                                            : Precision::kF32;
      s.fields.push_back({info.name, info.unit, info.width, precision});
      const size_t rows = system.field(state.systems[i], *f, scratch).rows;
      s.max_rows = std::max(s.max_rows, static_cast<uint32_t>(rows));
      if (rows != s.max_rows) s.rows = RowPolicy::kVariable;
    }
    if (s.fields.empty()) continue;
    const Topology topology = system.topology(state.systems[i]);
    for (const auto& l : topology.lines) s.lines.insert(s.lines.end(), l.begin(), l.end());
    for (const auto& t : topology.triangles) s.triangles.insert(s.triangles.end(), t.begin(), t.end());
    layout.systems.push_back(std::move(s));
  }
  for (size_t k = 0; k < params.fields.size(); ++k) {
    bool found = false;
    for (const RecordedSystem& s : layout.systems) {
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
  for (const RecordedSystem& s : writer_.layout().systems) {
    const size_t i = session.world().index_of(s.id);
    auto& keys = keys_.emplace_back();
    for (const RecordedField& f : s.fields) {
      const Scalar type = f.precision == Precision::kU32   ? Scalar::u32
                          : f.precision == Precision::kF64 ? Scalar::f64
                                                           : Scalar::f32;
      keys.push_back({static_cast<uint32_t>(i),
                      static_cast<uint32_t>(*field_index(session.world().system(i), f.name)), type});
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
  std::vector<SystemRows> systems(keys_.size());
  for (size_t i = 0; i < keys_.size(); ++i) {
    for (const FieldKey& key : keys_[i]) {
      const FrameBlock& b = *frame->find(key);
      const size_t n = b.rows * b.width;
      systems[i].rows = b.rows;
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
    systems[i].fields = values[i];
  }
  std::vector<double> observables;
  for (const RecordedObservable& o : writer_.layout().observables) {
    observables.push_back(frame->observables.find(o.name).value_or(std::nan("")));
  }
  writer_.append(static_cast<int64_t>(frame->step), frame->time, systems, observables);
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
