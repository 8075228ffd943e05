// The explicit table of everything a scene can hold: one row per system type. No plug-ins, no registration at
// start-up: a new system is a folder and one line in catalogue.cc.
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/build.h"
#include "engine/core/def.h"
#include "engine/core/outputs.h"
#include "engine/core/resolution.h"
#include "engine/core/system.h"

namespace truestep {

struct CatalogueRow {
  std::string_view type;      ///< as in a scene's "type"
  std::string_view group;     ///< equations, points, springs ...
  std::string_view sentence;  ///< what it is
  const DefTable* table;      ///< its parameters
  /// Builds the system from the struct that `table` describes.
  std::unique_ptr<const System> (*build)(const void* def, const BuildContext& context);
  /// Counts only; never allocates.
  Cost (*cost)(const void* def);
  std::vector<std::string_view> guarantees;  ///< what tests hold it to, one sentence each
  std::string_view default_integrator;       ///< empty: the system has its own method
  const Outputs* outputs;                    ///< what can be recorded, probed and observed
  double longest_substep = 10;               ///< s, beyond which nothing that it describes is resolved
  const Resolution* resolution = nullptr;    ///< null: no parameter divides anything
  std::vector<std::string_view> own_integrators = {};  ///< methods that are in no table and serve it alone
};

std::span<const CatalogueRow> catalogue();
/// The row of that type, or null.
const CatalogueRow* find_system_type(std::string_view type);

}  // namespace truestep
