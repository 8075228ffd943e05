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

void ProfileScope::end() {
  profile_->add(name_, std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
}

}  // namespace truestep
