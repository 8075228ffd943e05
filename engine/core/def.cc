#include "engine/core/def.h"

namespace truestep {

const ParamRow* DefTable::find(std::string_view name) const {
  for (const ParamRow& r : rows) {
    if (r.name == name) return &r;
  }
  return nullptr;
}

}  // namespace truestep
