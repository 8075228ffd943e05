// A scene: what a client POSTs and `truestep run` reads. The header and every system are read by their
// parameter tables; all faults are reported at once, each with its JSON pointer.
//
// Expectations name a quantity (scene/expected_quantity.h): an observable at the end ("energy.total", a
// probe's component "tip.position.y"), what a run did with it ("max(rope.strain.max)", "energy.drift"), or an
// expression of such.
#pragma once
#include <boost/json.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/errors.h"
#include "engine/core/def/build.h"
#include "engine/core/drawing.h"
#include "engine/scene/catalogue.h"
#include "engine/scene/coupling_catalogue.h"
#include "engine/scene/params/params.h"

namespace truestep {

/// s. Chemistry relaxes over 1e11 s (the Robertson problem) and more.
inline constexpr double kLongestDt = 1e13, kLongestDuration = 1e13;

struct TimeParams {
  double dt = 1.0 / 60;             ///< s, session step
  std::optional<int64_t> substeps;  ///< empty: one, or what default methods need (World)
  double duration = 10;             ///< s, what `run` and expectations cover
  int64_t max_catchup_steps = 8;    ///< steps that a late session may do at once
};

struct ProbeParams {
  std::string id, system;
  int64_t index = 0;       ///< row; negative counts from the end
  std::optional<Vec3> at;  ///< m, in a grid: instead of an index
  /// Of rows from `index` on, component by component; one: only that row.
  enum class Rows : uint8_t { one, least, greatest, mean } rows = Rows::one;
  std::vector<std::string> fields{"position"};
};

struct RecordingParams {
  int64_t every = 1;
  std::vector<std::string> fields;  ///< empty: position, or every field of a system that has none
  enum class Precision { f32, f64 } precision = Precision::f32;
};

struct CameraParams {
  Vec3 eye{3, 2, 4}, target{0, 1, 0}, up{0, 1, 0};
  double fov = 0.7;  ///< rad, vertical
};

/// Where a 3-D grid is cut to be shown.
struct SliceParams {
  enum class Axis : uint8_t { x, y, z } axis = Axis::z;
  std::optional<double> at;  ///< m; empty: in the middle
};

/// How particles that have a size are drawn.
enum class Liquid : uint8_t { balls, surface };

struct ViewerParams {
  std::optional<CameraParams> camera;
  std::string color_by;  ///< name of a field
  std::string legend;    ///< what its values mean; empty: its name
  ColorMap color_map = ColorMap::automatic;
  std::vector<std::string> names;  ///< of the values 0, 1, 2 ... of `color_by`, each in a colour of its own
  std::vector<double> range;       ///< lowest and highest value of the colours; empty: those shown
  std::optional<SliceParams> slice;
  std::optional<double> height;  ///< m per unit of the value
  Liquid liquid = Liquid::balls;
  int64_t contours = 0;
  int64_t streamlines = 0;
  bool labels = true;           ///< names above systems
  bool probe_labels = false;    ///< names beside the rows that probes watch
  std::optional<double> trail;  ///< s; for how long points leave a trail
};

struct ExpectParams {
  std::string quantity;
  std::optional<double> min, max, equals;
  double tolerance = 0;               ///< allowed |value - equals|
  std::optional<double> from, until;  ///< s, the part of the run that counts; empty: from start, to end
  double given = 0;                   ///< J that may come in unseen, of energy.gain and energy.loss
  std::string source;
};

/// How accurate a scene should be; the service then chooses method and step.
struct AccuracyParams {
  double tolerance = 1e-4;         ///< relative error of the quantity over the horizon
  std::string system;              ///< empty: the first that takes an integrator
  std::string quantity = "state";  ///< a field, or all numbers that say where the system is
  std::optional<double> horizon;   ///< s; empty: the scene's duration
};

struct SceneHeader {
  std::string schema;  ///< "$schema", free
  std::string schema_version = "1.0";
  std::string name, title, teaches;
  std::vector<std::string> tags;
  uint64_t seed = 0;
  Vec3 gravity{0, -9.81, 0};  ///< m/s^2
  TimeParams time;
  std::optional<AccuracyParams> accuracy;
  std::vector<std::string> observables;
  std::vector<ProbeParams> probes;
  std::optional<RecordingParams> recording;
  /// A session pauses at its last good step; there is no other way to go on from there.
  enum class OnInstability { pause } on_instability = OnInstability::pause;
  bool keep_running = false;  ///< playing continues when the last viewer has left
  ViewerParams viewer;
  std::vector<ExpectParams> expect;
};

/// The table of the header (everything but "systems" and "couplings").
const DefTable& scene_table();

struct SceneSystem {
  std::string id;
  const CatalogueRow* row = nullptr;
  std::shared_ptr<void> def;  ///< the struct that row->table describes
  size_t place = 0;           ///< in the document's list
  Reading reading = Reading::sound;
};

struct SceneCoupling {
  std::string id;
  size_t a = 0, b = 0;  ///< indices of the systems
  const CouplingRow* row = nullptr;
  std::shared_ptr<void> def;
  size_t place = 0;
  Reading reading = Reading::sound;
};

struct Scene {
  SceneHeader header;
  std::vector<SceneSystem> systems;
  std::vector<SceneCoupling> couplings;

  int64_t substeps() const { return header.time.substeps.value_or(1); }
  /// h = dt / substeps
  double substep() const { return header.time.dt / static_cast<double>(substeps()); }
  /// Index of the system that takes an integrator: the one named `id`, or the first when the id is empty.
  std::optional<size_t> integrated_system(std::string_view id) const;
  /// What a system of this scene is built with.
  BuildContext context(size_t system) const;
  /// The whole scene with defaults, in SI.
  boost::json::object canonical() const;
};

/// A scene or the reasons why there is none.
struct SceneReport {
  std::optional<Scene> scene;
  std::vector<Issue> errors, warnings;
  /// If there is no scene: the parts that could be read, for finding faults that only building reveals.
  /// Systems of unknown type are left out; `lost_ids` are theirs.
  std::optional<Scene> draft;
  std::vector<std::string> lost_ids;
};

/// Reads a parsed document. Never throws for anything a client can write.
SceneReport read_scene(const boost::json::value& document);
/// Strict JSON first (Error "bad_json"), then read_scene; Error "scene_invalid" with all issues.
Scene parse_scene(std::string_view text);
/// Throws the report's errors as Error "scene_invalid".
Scene require_scene(SceneReport report);

/// JSON Schema 2020-12 of a scene, from the same tables.
boost::json::object scene_schema();

}  // namespace truestep
