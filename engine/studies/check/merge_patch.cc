#include "engine/studies/check/merge_patch.h"

namespace truestep {

void merge_patch(boost::json::value& target, const boost::json::value& patch) {
  if (!patch.is_object()) {
    target = patch;
    return;
  }
  if (!target.is_object()) target.emplace_object();
  for (const auto& [key, value] : patch.as_object()) {
    if (value.is_null()) {
      target.as_object().erase(key);
    } else {
      merge_patch(target.as_object()[key], value);
    }
  }
}

}  // namespace truestep
