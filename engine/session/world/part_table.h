// The parts of a scene's systems under their public names, as used by scenes, streams and recordings: "water"
// is the main part of the system with that id, "water.boundary" another part of it.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/system.h"
#include "engine/scene/scene.h"

namespace truestep {

class PartTable {
 public:
  struct Entry {
    std::string id;
    size_t system = 0;      ///< index in the scene
    size_t index = 0;       ///< among the system's parts
    const System* of = {};  ///< outlives the table
    const PartInfo& info() const { return of->parts()[index]; }
    FieldView field(const State& state, size_t field, std::vector<double>& scratch) const {
      return of->field(state, index, field, scratch);
    }
  };
  PartTable() = default;
  /// Systems that are null contribute no parts.
  PartTable(const Scene& scene, std::span<const std::unique_ptr<const System>> systems);

  size_t size() const { return entries_.size(); }
  const Entry& operator[](size_t i) const { return entries_[i]; }
  auto begin() const { return entries_.begin(); }
  auto end() const { return entries_.end(); }

  /// Whether `name` means this part: its own id, or that of its system.
  bool named(size_t part, std::string_view name) const;
  /// The first field with this name in the parts that `name` means, main parts first.
  std::optional<FieldPlace> find(std::string_view name, std::string_view field) const;
  /// Names of all fields in these parts, each once; for an empty name, of all parts.
  std::vector<std::string> field_names(std::string_view name) const;
  /// Names of what colours can show, each once: fields of rows, cells, lines, triangles and joints, and the
  /// speed of what has velocities.
  std::vector<std::string> color_names() const;
  /// Ids of all parts, for messages.
  std::vector<std::string> ids() const;

 private:
  std::vector<Entry> entries_;
};

/// Element k of a view of any type.
double element(const FieldView& view, size_t k);

/// Names of a field's components: "tip.position.x", "tip.angle", "tip.orientation.0".
std::vector<std::string> component_names(const std::string& stem, uint32_t width);

}  // namespace truestep
