#include "engine/base/error_place.h"

namespace truestep {

Error placed_below(const Error& error, const std::string& pointer) {
  std::vector<Issue> issues = error.issues();
  if (issues.empty()) issues.push_back({"", error.code(), error.what(), "", "", "", ""});
  for (Issue& i : issues) i.pointer = pointer + i.pointer;
  return {error.code(), error.what(), std::move(issues)};
}

}  // namespace truestep
