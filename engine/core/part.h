// What a system has to show: parts, which are rows that belong together, and their fields, which say what
// their numbers mean, so that no field is recognised by its name. Streams, recordings, pictures, probes and
// the viewer iterate parts without knowing any system.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/state/state.h"
#include "engine/math/vec3.h"

namespace truestep {

/// What the numbers of a field mean to code that draws or compares them.
enum class Meaning : uint8_t {
  value,        ///< nothing in particular
  position,     ///< m, width 3: where the row is
  velocity,     ///< m/s, width 3
  orientation,  ///< unit quaternion (w, x, y, z) of the row's frame
  angle,        ///< rad, width 1: rotation of a row that lies in the plane
  asleep        ///< not 0: the row is not computed until it is woken
};

/// Something that can be streamed, recorded or drawn.
struct FieldInfo {
  std::string name;
  std::string unit;
  Scalar type = Scalar::f64;
  uint32_t width = 1;
  Meaning meaning = Meaning::value;
  /// Whether zero is its lower end, or the middle from which it deviates to both sides.
  enum class Scale : uint8_t { amount, deviation } scale = Scale::amount;
  std::vector<std::string> kinds = {};  ///< names of its values 0, 1, 2 ... when these are kinds, not amounts
};

/// rows x width elements of a field, either inside the state or inside the scratch passed in.
struct FieldView {
  const void* data = nullptr;
  Scalar type = Scalar::f64;
  size_t rows = 0;
  uint32_t width = 1;
};

/// Where the rows of a grid are: row x + counts[0] * (y + counts[1] * z) lies at origin + (x, y, z) *
/// spacing.
struct Lattice {
  std::array<uint32_t, 3> counts{1, 1, 1};  ///< 1 along a direction that the grid does not have
  Vec3 origin;                              ///< m, position of row 0: a node, or the centre of a cell
  Vec3 spacing{1, 1, 1};                    ///< m
  enum class Centring : uint8_t { nodes, cells } centring = Centring::nodes;

  size_t rows() const { return size_t{counts[0]} * counts[1] * counts[2]; }
  int dimensions() const { return (counts[0] > 1) + (counts[1] > 1) + (counts[2] > 1); }
  friend bool operator==(const Lattice&, const Lattice&) = default;
};

struct PartInfo {
  enum class Kind : uint8_t {
    points,  ///< rows with a position: particles, nodes, bodies; the first field is their position
    grid,    ///< cells or nodes of `lattice`
    values   ///< rows without a position: elements, joints, components
  } kind = Kind::points;
  std::string name;  ///< empty: the main part, with the system's id; otherwise its id is <system>.<name>
  std::vector<FieldInfo> fields;  ///< all have the same rows
  size_t max_rows = 0;            ///< upper bound of the number of rows
  Lattice lattice;                ///< of a grid
  size_t trail = 0;  ///< rows that follow each row and record where it was: its trail, newest first
  /// What shows the rows of values by its colour: row k the k-th line that the main part draws, the triangles
  /// whose PartDrawing::triangle_elements is k, or the mark of the joint whose JointMark::row is k.
  enum class Elements : uint8_t { none, lines, triangles, joints } elements = Elements::none;

  /// Whether colours can show its fields: on rows, on cells, or on what belongs to an element.
  bool colorable() const { return kind != Kind::values || elements != Elements::none; }

  std::optional<size_t> find(std::string_view field) const;
  /// The first field with this meaning.
  std::optional<size_t> find(Meaning meaning) const;
};

/// A field among all parts of a system or of a world.
struct FieldPlace {
  size_t part = 0, field = 0;
};

/// As in streams and recordings: "value", "position" ...
constexpr std::string_view name_of(Meaning meaning) {
  constexpr std::string_view kNames[] = {"value", "position", "velocity", "orientation", "angle", "asleep"};
  return kNames[static_cast<size_t>(meaning)];
}
inline constexpr size_t kMeanings = 6;

/// As in streams: "", "deviation".
constexpr std::string_view name_of(FieldInfo::Scale scale) {
  return scale == FieldInfo::Scale::deviation ? "deviation" : "";
}

/// As in streams and recordings: "points", "grid", "values".
constexpr std::string_view name_of(PartInfo::Kind kind) {
  return kind == PartInfo::Kind::points ? "points" : kind == PartInfo::Kind::grid ? "grid" : "values";
}

/// As in streams: "", "lines", "triangles", "joints".
constexpr std::string_view name_of(PartInfo::Elements elements) {
  constexpr std::string_view kNames[] = {"", "lines", "triangles", "joints"};
  return kNames[static_cast<size_t>(elements)];
}

}  // namespace truestep

// Every system makes these; their members are compiled once, in part.cc.
extern template class std::vector<truestep::FieldInfo>;
extern template class std::vector<truestep::PartInfo>;
