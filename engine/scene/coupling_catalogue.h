// The explicit table of everything two systems can do to each other: one row per coupling type.
#pragma once
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "engine/core/coupling.h"
#include "engine/core/def/build.h"
#include "engine/core/def/def.h"

namespace truestep {

struct CouplingRow {
  std::string_view type;      ///< as in a coupling's "type"
  std::string_view sentence;  ///< what it is
  const DefTable* table;      ///< its parameters
  /// Builds the coupling from the struct that `table` describes. Error "scene_invalid" with pointers below
  /// the coupling's object when it does not fit its sides.
  std::unique_ptr<const Coupling> (*build)(const void* def, const CouplingContext& context);
  /// What it adds to the costs of its two sides; counts only, never allocates.
  Cost (*cost)(const void* def, const Cost& a, const Cost& b);
  std::vector<std::string_view> guarantees;  ///< what tests check, one sentence each
  bool touches = false;                      ///< whether points meet the bodies of the other side
};

std::span<const CouplingRow> coupling_catalogue();
/// The row with that type, or null.
const CouplingRow* find_coupling_type(std::string_view type);

}  // namespace truestep
