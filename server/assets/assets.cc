// Looks up the viewer's files by binary search in the table that embed.cmake generates.
#include "server/assets/assets.h"

#include <algorithm>

namespace truestep {

const Asset* find_asset(std::string_view path) {
  if (path == "/") path = "/index.html";
  const std::span<const Asset> assets = all_assets();
  const auto found = std::lower_bound(assets.begin(), assets.end(), path,
                                      [](const Asset& a, std::string_view p) { return a.path < p; });
  return found != assets.end() && found->path == path ? &*found : nullptr;
}

}  // namespace truestep
