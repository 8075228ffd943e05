// The definition of shallow water in a scene; see heightfield_wave.h.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/def/resolution.h"
#include "engine/core/outputs.h"
#include "engine/kernels/shallow/water.h"

namespace truestep::heightfield_wave {

struct EdgeDef {
  enum class Kind : uint8_t { wall, open, periodic } kind = Kind::wall;
};
struct EdgesDef {
  std::optional<EdgeDef> x_min, x_max, y_min, y_max;
  /// In the order x_min, x_max, y_min, y_max.
  const std::optional<EdgeDef>& of(size_t axis, size_t end) const;
};

struct HeightfieldWaveDef {
  std::vector<int64_t> cells = {64, 64};
  std::vector<double> size;    ///< m; empty: 1 along every axis
  std::optional<Vec3> origin;  ///< m, lower corner; heights are measured from its z
  std::optional<EdgeDef> all;
  EdgesDef sides;
  std::string bed = "0", surface = "0.1";  ///< m
  std::vector<std::string> velocity;       ///< m/s, at the start
  std::string exact;                       ///< m, exact surface; empty: unknown
  double friction = 0;
  double density = 1000;  ///< kg/m^3
  double cfl = 0.45;
  std::optional<double> dry_depth;  ///< m
};

const DefTable& heightfield_wave_table();
const Outputs& heightfield_wave_outputs();
Cost heightfield_wave_cost(const void* def);
/// On one core, of a substep of two stages.
double heightfield_substep_seconds(const HeightfieldWaveDef& def);
const Resolution& heightfield_wave_resolution();

EdgeDef::Kind edge_of(const HeightfieldWaveDef& d, size_t axis, size_t end);
/// Cells and sides as given by the scene.
shallow::Basin make_basin(const HeightfieldWaveDef& d);

}  // namespace truestep::heightfield_wave
