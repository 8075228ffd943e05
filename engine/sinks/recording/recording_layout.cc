#include "engine/sinks/recording/recording_layout.h"

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/base/version.h"
#include "engine/scene/json/json_write.h"
#include "engine/sinks/recording/recorded_drawing.h"

namespace truestep {

namespace {

[[noreturn]] void refuse(size_t index, const std::string& message) {
  throw Error("scene_invalid", message,
              {"/recording/fields/" + std::to_string(index), "unknown_field", message, "", "", "", ""});
}

// Observables that a recording keeps: those named by the scene, or all if it names none; probes always.
bool wants_observable(const Scene& scene, std::string_view name) {
  const auto& wanted = scene.header.observables;
  const auto& probes = scene.header.probes;
  return wanted.empty() ||
         std::any_of(wanted.begin(), wanted.end(), [&](const std::string& w) { return selects(w, name); }) ||
         std::any_of(probes.begin(), probes.end(), [&](const auto& p) { return selects(p.id, name); });
}

bool colors(const FieldInfo& field, const std::string& color_by) {
  return field.name == color_by || (color_by == "speed" && field.meaning == Meaning::velocity);
}

bool usual(const PartInfo& part, const FieldInfo& field, const std::string& color_by) {
  if (colors(field, color_by)) return true;
  switch (part.kind) {
    case PartInfo::Kind::points:
      return field.meaning != Meaning::value && field.meaning != Meaning::velocity;
    case PartInfo::Kind::grid:
      return true;
    case PartInfo::Kind::values:
      return part.name.empty();
  }
  return false;
}

// Fields of a part to record: the named ones, otherwise the usual ones.
std::vector<size_t> wanted_fields(const PartInfo& part, const RecordingParams& params,
                                  const std::string& color_by) {
  std::vector<size_t> out;
  const auto& names = params.fields;
  for (size_t f = 0; f < part.fields.size(); ++f) {
    const FieldInfo& field = part.fields[f];
    const bool named = std::find(names.begin(), names.end(), field.name) != names.end();
    if (names.empty() ? usual(part, field, color_by) : named) out.push_back(f);
  }
  return out;
}

std::optional<Precision> precision_of(Scalar type, RecordingParams::Precision wanted) {
  if (type == Scalar::u32) return Precision::kU32;
  if (type != Scalar::f64 && type != Scalar::f32) return std::nullopt;
  return wanted == RecordingParams::Precision::f64 && type == Scalar::f64 ? Precision::kF64 : Precision::kF32;
}

class Planner {
 public:
  Planner(const World& world, const std::string& path, RecordingParams asked)
      : world_(world), state_(world.initial_state()), params_(std::move(asked)) {
    const Scene& scene = world.scene();
    RecordingLayout& layout = out_.layout;
    layout.path = path;
    layout.scene_json = write_json(scene.canonical());
    layout.seed = scene.header.seed;
    layout.dt = world.dt();
    layout.build = std::string(version()) + ' ' + std::string(build_description());
    world.draw(state_, Wish::constant | Wish::obstacles, drawing_);
  }

  PlannedRecording plan() {
    for (size_t p = 0; p < world_.parts().size(); ++p) add_part(p);
    check_names();
    if (params_.fields.empty() && !drawing_.obstacles.empty()) add_obstacles();
    for (const Observation& o : world_.known_observables()) {
      if (wants_observable(world_.scene(), o.name)) out_.layout.observables.push_back({o.name, o.unit});
    }
    out_.layout.drawing = recorded_drawing(out_.sources, drawing_, drawing_.obstacles);
    return std::move(out_);
  }

 private:
  void add_part(size_t p) {
    const PartTable::Entry& entry = world_.parts()[p];
    const PartInfo& part = entry.info();
    RecordedPart s;
    RecordedSource source{p, {}, part.trail + 1};
    s.id = entry.id;
    s.type = world_.scene().systems[entry.system].row->type;
    s.kind = part.kind;
    s.lattice = part.lattice;
    size_t rows = 0;
    for (const size_t f : wanted_fields(part, params_, world_.scene().header.viewer.color_by)) {
      const FieldInfo& info = part.fields[f];
      const auto precision = precision_of(info.type, params_.precision);
      if (!precision) continue;
      s.fields.push_back({info.name, info.unit, info.width, *precision, info.meaning});
      source.fields.push_back(f);
      rows = entry.field(state_.systems[entry.system], f, scratch_).rows / source.stride;
    }
    if (s.fields.empty()) return;
    s.max_rows = static_cast<uint32_t>(std::max(part.max_rows / source.stride, rows));
    s.usual_rows = static_cast<uint32_t>(std::max<size_t>(rows, 1));
    // Rows that have ids of their own come and go: bodies merge.
    if (rows != s.max_rows || part.find("id")) s.rows = RowPolicy::kVariable;
    const PartDrawing& look = drawing_.parts[p];
    for (size_t i = 0; part.trail == 0 && i < look.lines.size(); ++i)
      s.lines.insert(s.lines.end(), look.lines[i].begin(), look.lines[i].end());
    for (const auto& t : look.triangles) s.triangles.insert(s.triangles.end(), t.begin(), t.end());
    out_.layout.parts.push_back(std::move(s));
    out_.sources.push_back(std::move(source));
  }

  void check_names() const {
    for (size_t k = 0; k < params_.fields.size(); ++k) {
      bool found = false;
      for (const RecordedPart& s : out_.layout.parts) {
        for (const RecordedField& f : s.fields) found |= f.name == params_.fields[k];
      }
      if (!found) refuse(k, "no system has a field \"" + params_.fields[k] + "\" that can be recorded");
    }
  }

  // Obstacles move, too, and carry their shapes as bodies do.
  void add_obstacles() {
    RecordedPart s;
    s.id = "obstacles";
    const auto taken = [&](const RecordedPart& other) { return other.id == s.id; };
    while (std::ranges::any_of(out_.layout.parts, taken)) s.id += '_';
    s.type = "obstacles";
    s.max_rows = static_cast<uint32_t>(drawing_.obstacles.size());
    const Precision precision =
        params_.precision == RecordingParams::Precision::f64 ? Precision::kF64 : Precision::kF32;
    s.fields = {{"position", "m", 3, precision, Meaning::position},
                {"orientation", "1", 4, precision, Meaning::orientation}};
    out_.layout.parts.push_back(std::move(s));
    out_.sources.push_back({});
  }

  const World& world_;
  const WorldState state_;
  RecordingParams params_;
  Drawing drawing_;
  std::vector<double> scratch_;
  PlannedRecording out_;
};

}  // namespace

PlannedRecording plan_recording(const World& world, const std::string& path, const RecordingParams& asked) {
  return Planner(world, path, asked).plan();
}

RecordedDrawing recorded_drawing(const std::vector<RecordedSource>& sources, const Drawing& constant,
                                 std::span<const DrawnShape> obstacles) {
  std::vector<const PartDrawing*> parts;
  bool with_obstacles = false;
  for (const RecordedSource& s : sources) {
    with_obstacles |= !s.part;
    if (s.part) parts.push_back(&constant.parts[*s.part]);
  }
  return recorded_drawing(parts, with_obstacles ? obstacles : std::span<const DrawnShape>());
}

}  // namespace truestep
