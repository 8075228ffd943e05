#include "engine/core/def.h"

#include <algorithm>

namespace truestep {

const ParamRow* DefTable::find(std::string_view name) const {
  for (const ParamRow& r : rows) {
    if (r.name == name || std::find(r.also.begin(), r.also.end(), name) != r.also.end()) return &r;
  }
  return nullptr;
}

}  // namespace truestep
