// The explicit table of everything a scene can contain: one row per system type. No plug-ins, no registration
// at start-up: a new system is a folder and one line in catalogue.cc.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/def/resolution.h"
#include "engine/core/equations/integrator.h"
#include "engine/core/outputs.h"
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
  std::vector<std::string_view> guarantees;  ///< what tests check, one sentence each
  std::string_view default_integrator;       ///< empty: the system has its own method
  const Outputs* outputs;                    ///< what can be recorded, probed and observed
  double longest_substep = 10;               ///< s, longest substep that still resolves anything it describes
  const Resolution* resolution = nullptr;    ///< null: it has no resolution parameter
  std::vector<std::string_view> own_integrators = {};  ///< methods outside the table that serve only this
                                                       ///< type
  /// What the methods of the table are given to integrate: accelerations by forces, rates y' = f(t, y), or
  /// rates that never are of second order.
  enum class Equations : uint8_t { forces, rates, first_order } equations = Equations::forces;
};

std::span<const CatalogueRow> catalogue();
/// The row with that type, or null.
const CatalogueRow* find_system_type(std::string_view type);
/// Whether some scene of that type can be integrated by the method: GET /v1/systems lists those. A scene may
/// have forces that a method refuses all the same.
bool serves(const Integrator& method, const CatalogueRow& row);

}  // namespace truestep
