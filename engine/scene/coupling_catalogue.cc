#include "engine/scene/coupling_catalogue.h"

#include "engine/couplings/attachment.h"

namespace truestep {

std::span<const CouplingRow> coupling_catalogue() {
  static const std::vector<CouplingRow> kRows = {
      {"attachment",
       "joins points of two systems, pair by pair, with springs or rigid links",
       &attachment_table(),
       build_attachment,
       attachment_cost,
       {"what one side gains in momentum the other loses", "second order in the step",
        "a rigid link keeps its length to rounding"}},
  };
  return kRows;
}

const CouplingRow* find_coupling_type(std::string_view type) {
  for (const CouplingRow& row : coupling_catalogue()) {
    if (row.type == type) return &row;
  }
  return nullptr;
}

}  // namespace truestep
