#include "engine/base/profile.h"

namespace truestep {

void Profile::add(std::string_view name, double seconds) {
  for (Row& row : rows_) {
    if (row.name == name) {
      row.seconds += seconds;
      ++row.calls;
      return;
    }
  }
  rows_.push_back({std::string(name), seconds, 1});
}

}  // namespace truestep
