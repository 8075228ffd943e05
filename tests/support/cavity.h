// Published profiles of the lid-driven cavity.
#pragma once
#include "tests/support/grid_flow.h"

namespace truestep::test {

struct CavityPoint {
  double at, value;
};
// Spectral solutions of Botella and Peyret at Re 1000: u(0.5, y) and v(x, 0.5).
inline constexpr CavityPoint kCavityU[] = {{0.0547, -0.1812881}, {0.0625, -0.20233},  {0.0703, -0.2228955},
                                           {0.1016, -0.3004561}, {0.1719, -0.388569}, {0.2813, -0.2803696},
                                           {0.4531, -0.1081999}, {0.5, -0.0620561},   {0.6172, 0.0570178},
                                           {0.7344, 0.1886747},  {0.8516, 0.3372212}, {0.9531, 0.4723329},
                                           {0.9609, 0.5169277},  {0.9688, 0.5808359}, {0.9766, 0.6644227}};
inline constexpr CavityPoint kCavityV[] = {{0.0625, 0.2807056},  {0.0703, 0.2962703},  {0.0781, 0.3099097},
                                           {0.0938, 0.3330442},  {0.1563, 0.3769189},  {0.2266, 0.3339924},
                                           {0.2344, 0.3253592},  {0.5, 0.0257995},     {0.8047, -0.3202137},
                                           {0.8594, -0.4264545}, {0.9063, -0.5264392}, {0.9453, -0.4103754},
                                           {0.9531, -0.3553213}, {0.9609, -0.2936869}, {0.9688, -0.2279225}};

inline double cavity_rms(const GridFlow& run) {
  double sum = 0;
  for (const CavityPoint& p : kCavityU) sum += std::pow(run.velocity(0, 0.5, p.at) - p.value, 2);
  for (const CavityPoint& p : kCavityV) sum += std::pow(run.velocity(1, p.at, 0.5) - p.value, 2);
  return std::sqrt(sum / double(std::size(kCavityU) + std::size(kCavityV)));
}

/// The cavity of these profiles, solved directly for the steady state.
inline grid_fluid::GridFluidDef steady_cavity(int64_t cells, grid_fluid::GridFluidDef::Order order) {
  grid_fluid::GridFluidDef d;
  d.cells = {cells, cells};
  d.viscosity = 1e-3;
  d.stepping = grid_fluid::GridFluidDef::Stepping::steady;
  d.order = order;
  d.sides.y_max = grid_fluid::FlowSideDef{grid_fluid::SideKind::wall, {"1", "0"}};
  return d;
}

}  // namespace truestep::test
