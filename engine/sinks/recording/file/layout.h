// What a recording holds, in plain data: parts with their fields, observables and the parameters that
// reproduce the run. The layout is fixed when a recording begins, only the number of frames grows.
// It knows no World and no Session, so a file can be written and rebuilt without either.
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
};

/// One number per frame.
struct RecordedObservable {
  std::string name;
  std::string unit;
};

/// Everything that is known before the first frame.
struct RecordingLayout {
  std::string path;
  std::vector<RecordedPart> parts;
  std::vector<RecordedObservable> observables;
  std::string scene_json;
  uint64_t seed = 0;
  double dt = 0;      ///< s
  std::string build;  ///< version, compiler, flags: whatever identifies the program
};

/// Borrowed rows of one field, converted to the field's precision when they are taken.
using FieldValues = std::variant<std::span<const double>, std::span<const float>, std::span<const uint32_t>>;

/// Borrowed rows of one part: `rows` rows of every field, in the layout's order.
struct PartRows {
  size_t rows = 0;
  std::span<const FieldValues> fields;
};

/// Throws Error("recording_invalid") listing every name, size or index of `layout` that cannot be recorded.
void validate_layout(const RecordingLayout& layout);

}  // namespace truestep
