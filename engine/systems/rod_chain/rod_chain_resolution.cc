// Refinement of a chain of rods: more and shorter ones of the same total length and mass. Joints that are
// springs stand in series, so that n of k are as stiff as 2 n of 2 k. In the limit it is a flexible,
// inextensible thread. Centres of rods lie elsewhere at every resolution; the ends of the coarse ones are
// ends of fine ones too.
#include "engine/core/def/resolution.h"
#include "engine/systems/rod_chain/rod_chain.h"

namespace truestep::rod_chain {

namespace {

std::optional<std::string> divide(void* def, double factor) {
  auto& d = *static_cast<RodChainDef*>(def);
  if (!divided(d.links, factor, 1, 1e5)) return "the number of links must be whole, from 1 to 100000";
  d.length /= factor, d.mass /= factor;
  d.stiffness *= factor, d.damping *= factor;
  return std::nullopt;
}

// The ends of the rods, as shares of the chain's length.
std::vector<Vec3> places(const void* def) {
  const auto& d = *static_cast<const RodChainDef*>(def);
  std::vector<Vec3> out;
  for (int64_t j = 1; j <= d.links; ++j)
    out.push_back({static_cast<double>(j) / static_cast<double>(d.links), 0, 0});
  return out;
}

}  // namespace

const Resolution& rod_chain_resolution() {
  static const Resolution kLinks{.parameter = "links",
                                 .divide = divide,
                                 .order = [](const void*) { return 0; },
                                 .places = places,
                                 .part = 1};
  return kLinks;
}

}  // namespace truestep::rod_chain
