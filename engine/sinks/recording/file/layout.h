// The contents of a recording, as plain data: parts with their fields, observables and the parameters that
// reproduce the run. The layout is fixed when a recording begins; only the number of frames grows. It knows
// no World and no Session, so a file can be written and rebuilt without either.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "engine/core/part.h"

namespace truestep {

/// Element type of a recorded field.
enum class Precision { kF32, kF64, kU32 };

/// Whether a part has the same rows in every frame or a number that changes (emitters).
enum class RowPolicy { kFixed, kVariable };

/// One array of a part: rows x width elements in SI units.
struct RecordedField {
  std::string name;
  std::string unit;
  uint32_t width = 1;
  Precision precision = Precision::kF32;
  Meaning meaning = Meaning::value;
};

/// One part: `max_rows` rows at most, its fields and what connects them (indices of rows).
struct RecordedPart {
  std::string id;
  std::string type;  ///< of its system
  uint32_t max_rows = 0;
  RowPolicy rows = RowPolicy::kFixed;
  std::vector<RecordedField> fields;
  std::vector<uint32_t> lines;      ///< pairs
  std::vector<uint32_t> triangles;  ///< triples
  PartInfo::Kind kind = PartInfo::Kind::points;
  Lattice lattice = {};  ///< of a grid; it has as many rows
  /// Expected rows when their number varies: space is reserved for these first; 0: for all of max_rows.
  uint32_t usual_rows = 0;
};

/// The solids attached to rows of a part, as columns: shape k has entry k of each.
struct RecordedShapes {
  std::vector<uint32_t> instances;   ///< pairs: row, shape
  std::vector<uint32_t> kinds;       ///< DrawnShape::Kind
  std::vector<double> positions;     ///< m, 3 each, in the row's frame
  std::vector<double> orientations;  ///< 4 each: w x y z
  std::vector<double> sizes;         ///< m, 3 each, as in DrawnShape
  std::vector<double> colors;        ///< sRGB in [0, 1], 3 each; NaN for a shape without one
  std::vector<uint32_t> motions;     ///< Visual::Motion
  std::vector<uint32_t> groups;      ///< shapes of one group look alike when they have no colour
  std::vector<uint32_t> meshes;      ///< index in RecordedDrawing::meshes, or kNoMesh
  double point_radius = 0;           ///< m; 0: rows without shapes are not drawn as spheres
  static constexpr uint32_t kNoMesh = UINT32_MAX;
};

/// Triangles in a shape's own frame.
struct RecordedMesh {
  std::vector<float> positions;     ///< m, 3 each
  std::vector<uint32_t> triangles;  ///< 3 each
};

/// The look of a recording's rows, recorded once.
struct RecordedDrawing {
  std::vector<RecordedShapes> parts;  ///< in the layout's order
  std::vector<RecordedMesh> meshes;
};

/// One number per frame.
struct RecordedObservable {
  std::string name;
  std::string unit;
};

/// Everything known before the first frame.
struct RecordingLayout {
  std::string path;
  std::vector<RecordedPart> parts;
  std::vector<RecordedObservable> observables;
  RecordedDrawing drawing;
  std::string scene_json;
  uint64_t seed = 0;
  double dt = 0;      ///< s
  std::string build;  ///< version, compiler, flags: whatever identifies the program
};

/// Borrowed rows of one field, converted to the field's precision when they are stored.
using FieldValues = std::variant<std::span<const double>, std::span<const float>, std::span<const uint32_t>>;

/// Borrowed rows of one part: `rows` rows of every field, in the layout's order.
struct PartRows {
  size_t rows = 0;
  std::span<const FieldValues> fields;
};

/// Throws Error("recording_invalid") listing every name, size or index of `layout` that cannot be recorded.
void validate_layout(const RecordingLayout& layout);

}  // namespace truestep
