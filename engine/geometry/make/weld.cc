#include "engine/geometry/make/weld.h"

#include <array>
#include <map>

namespace truestep {

std::vector<uint32_t> first_at_place(std::span<const Vec3> vertices) {
  std::map<std::array<double, 3>, uint32_t> known;
  std::vector<uint32_t> out;
  out.reserve(vertices.size());
  for (const Vec3& p : vertices) {
    out.push_back(known.emplace(std::array{p.x, p.y, p.z}, static_cast<uint32_t>(out.size())).first->second);
  }
  return out;
}

}  // namespace truestep
