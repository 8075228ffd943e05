// What a system has to show: parts, which are rows that belong together, and their fields, which say what
// their numbers mean, so that nobody recognises a field by its name. Streams, recordings, pictures, probes
// and the viewer iterate parts and know no system.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/state.h"
#include "engine/math/vec3.h"

namespace truestep {

/// What the numbers of a field are for whoever draws or compares them.
enum class Meaning : uint8_t {
  value,        ///< nothing in particular
  position,     ///< m, width 3: where the row is
  velocity,     ///< m/s, width 3
  orientation,  ///< unit quaternion (w, x, y, z) of the row's frame
  angle,        ///< rad, width 1: turn of a row that lies in the plane
  asleep        ///< not 0: the row is not computed until something wakes it
};

/// Something that may be streamed, recorded or drawn.
struct FieldInfo {
  std::string name;
  std::string unit;
  Scalar type = Scalar::f64;
  uint32_t width = 1;
  Meaning meaning = Meaning::value;
};

/// rows x width elements of a field, either inside the state or inside the scratch that was handed over.
struct FieldView {
  const void* data = nullptr;
  Scalar type = Scalar::f64;
  size_t rows = 0;
  uint32_t width = 1;
};

/// Where the rows of a grid are: row x + counts[0] * (y + counts[1] * z) lies at origin + (x, y, z) *
/// spacing.
struct Lattice {
  std::array<uint32_t, 3> counts{1, 1, 1};  ///< along a direction that the grid does not have: 1
  Vec3 origin;                              ///< m, place of row 0: a node, or the centre of a cell
  Vec3 spacing{1, 1, 1};                    ///< m
  enum class Centring : uint8_t { nodes, cells } centring = Centring::nodes;

  size_t rows() const { return size_t{counts[0]} * counts[1] * counts[2]; }
  int dimensions() const { return (counts[0] > 1) + (counts[1] > 1) + (counts[2] > 1); }
  friend bool operator==(const Lattice&, const Lattice&) = default;
};

struct PartInfo {
  enum class Kind : uint8_t {
    points,  ///< rows with a place: particles, nodes, bodies; the first field is their position
    grid,    ///< cells or nodes of `lattice`
    values   ///< rows without a place: elements, joints, components
  } kind = Kind::points;
  std::string name;  ///< empty: the main part, with the system's id; else its id is <system>.<name>
  std::vector<FieldInfo> fields;  ///< all have the same rows
  size_t max_rows = 0;            ///< upper bound of what the rows may grow to
  Lattice lattice;                ///< of a grid
  size_t trail =
      0;  ///< rows that follow each row of its own and say where that one was: its path, newest first
  /// Row k of values is the k-th line or triangle that the main part draws, which its colours then show.
  enum class Elements : uint8_t { none, lines, triangles } elements = Elements::none;

  std::optional<size_t> find(std::string_view field) const {
    const auto is = [&](const FieldInfo& f) { return f.name == field; };
    const auto at = std::find_if(fields.begin(), fields.end(), is);
    return at == fields.end() ? std::nullopt : std::optional(static_cast<size_t>(at - fields.begin()));
  }
  /// The first field of this meaning.
  std::optional<size_t> find(Meaning meaning) const {
    const auto is = [&](const FieldInfo& f) { return f.meaning == meaning; };
    const auto at = std::find_if(fields.begin(), fields.end(), is);
    return at == fields.end() ? std::nullopt : std::optional(static_cast<size_t>(at - fields.begin()));
  }
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

/// As in streams and recordings: "points", "grid", "values".
constexpr std::string_view name_of(PartInfo::Kind kind) {
  return kind == PartInfo::Kind::points ? "points" : kind == PartInfo::Kind::grid ? "grid" : "values";
}

}  // namespace truestep
