#include "engine/scene/catalogue.h"

namespace truestep {

std::span<const CatalogueRow> catalogue() {
  static const std::vector<CatalogueRow> kRows = {};
  return kRows;
}

const CatalogueRow* find_system_type(std::string_view type) {
  for (const CatalogueRow& row : catalogue()) {
    if (row.type == type) return &row;
  }
  return nullptr;
}

}  // namespace truestep
