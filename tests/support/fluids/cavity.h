// Published profiles of the lid-driven cavity.
#pragma once
#include <span>

#include "tests/support/fluids/grid_flow.h"

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

// Reynolds number 100: differences of second order on 128 and 256 cells, extrapolated (case
// euler.cavity_Re100).
inline constexpr CavityPoint kCavityU100[] = {
    {0.0547, -0.03723}, {0.0625, -0.04198}, {0.0703, -0.04662}, {0.1016, -0.06443}, {0.1719, -0.10174},
    {0.2813, -0.15767}, {0.4531, -0.21398}, {0.5, -0.20915},    {0.6172, -0.1388},  {0.7344, 0.00419},
    {0.8516, 0.23655},  {0.9531, 0.69103},  {0.9609, 0.74047},  {0.9688, 0.79194},  {0.9766, 0.84373}};
inline constexpr CavityPoint kCavityV100[] = {
    {0.0625, 0.09481},  {0.0703, 0.10359},  {0.0781, 0.11175},  {0.0938, 0.12643},  {0.1563, 0.16483},
    {0.2266, 0.17936},  {0.2344, 0.17956},  {0.5, 0.05754},     {0.8047, -0.25354}, {0.8594, -0.23369},
    {0.9063, -0.17708}, {0.9453, -0.10853}, {0.9531, -0.09339}, {0.9609, -0.07798}, {0.9688, -0.06219}};
// Ghia, Ghia, Shin 1982, table I at Reynolds number 3200; y = 0.4531 is left out, where the table has
// -0.86636 and neighbours of -0.04 and -0.24.
inline constexpr CavityPoint kCavityU3200[] = {
    {0.0547, -0.32407}, {0.0625, -0.35344}, {0.0703, -0.37827}, {0.1016, -0.41933}, {0.1719, -0.34323},
    {0.2813, -0.24427}, {0.5, -0.04272},    {0.6172, 0.07156},  {0.7344, 0.19791},  {0.8516, 0.34682},
    {0.9531, 0.46101},  {0.9609, 0.46547},  {0.9688, 0.48296},  {0.9766, 0.53236}};
// Erturk, Corke, Gokcol 2005, "Numerical solutions of 2-D steady incompressible driven cavity flow at high
// Reynolds numbers", tables of u and v on 601^2 nodes, to four digits.
inline constexpr CavityPoint kCavityU5000[] = {
    {0.02, -0.2223}, {0.04, -0.348},  {0.06, -0.4272}, {0.08, -0.4419}, {0.1, -0.4168}, {0.12, -0.3876},
    {0.14, -0.3652}, {0.16, -0.3467}, {0.18, -0.3285}, {0.2, -0.31},    {0.5, -0.0319}, {0.9, 0.4155},
    {0.91, 0.4307},  {0.92, 0.4452},  {0.93, 0.4582},  {0.94, 0.4683},  {0.95, 0.4738}, {0.96, 0.4739},
    {0.97, 0.4749},  {0.98, 0.5159},  {0.99, 0.6866}};
inline constexpr CavityPoint kCavityV5000[] = {
    {0.015, 0.216},   {0.03, 0.3263},  {0.045, 0.3868},  {0.06, 0.4258},  {0.075, 0.4426},  {0.09, 0.4403},
    {0.105, 0.426},   {0.12, 0.407},   {0.135, 0.3878},  {0.15, 0.3699},  {0.5, 0.0117},    {0.85, -0.3624},
    {0.865, -0.3806}, {0.88, -0.3982}, {0.895, -0.4147}, {0.91, -0.4318}, {0.925, -0.4595}, {0.94, -0.5139},
    {0.955, -0.57},   {0.97, -0.5019}, {0.985, -0.2441}};
inline constexpr CavityPoint kCavityU10000[] = {
    {0.02, -0.2907}, {0.04, -0.4259}, {0.06, -0.4469}, {0.08, -0.4142}, {0.1, -0.3899}, {0.12, -0.3721},
    {0.14, -0.3543}, {0.16, -0.3361}, {0.18, -0.3179}, {0.2, -0.2998},  {0.5, -0.0268}, {0.9, 0.4095},
    {0.91, 0.4243},  {0.92, 0.4398},  {0.93, 0.4556},  {0.94, 0.4711},  {0.95, 0.4843}, {0.96, 0.4917},
    {0.97, 0.4891},  {0.98, 0.4837},  {0.99, 0.5891}};
inline constexpr CavityPoint kCavityV10000[] = {
    {0.015, 0.2756},  {0.03, 0.3844},  {0.045, 0.4409},  {0.06, 0.4566},  {0.075, 0.4449},  {0.09, 0.4247},
    {0.105, 0.4056},  {0.12, 0.3885},  {0.135, 0.3722},  {0.15, 0.3562},  {0.5, 0.0088},    {0.85, -0.3538},
    {0.865, -0.3715}, {0.88, -0.3895}, {0.895, -0.4078}, {0.91, -0.4256}, {0.925, -0.4411}, {0.94, -0.4592},
    {0.955, -0.5124}, {0.97, -0.5712}, {0.985, -0.3419}};

/// What is published of u(0.5, y) and v(x, 0.5) at a Reynolds number; nothing at those that are not listed.
struct CavityProfiles {
  std::span<const CavityPoint> u, v;
};
inline CavityProfiles cavity_profiles(int reynolds) {
  switch (reynolds) {
    case 100:
      return {kCavityU100, kCavityV100};
    case 1000:
      return {kCavityU, kCavityV};
    case 3200:
      return {kCavityU3200, {}};
    case 5000:
      return {kCavityU5000, kCavityV5000};
    case 10000:
      return {kCavityU10000, kCavityV10000};
    default:
      return {};
  }
}

/// Root mean square and largest distance from what is published.
struct CavityError {
  double rms = 0, largest = 0;
};
inline CavityError cavity_error(const GridFlow& run, int reynolds) {
  const CavityProfiles published = cavity_profiles(reynolds);
  CavityError e;
  const auto add = [&](double off) { e.rms += off * off, e.largest = std::max(e.largest, std::abs(off)); };
  for (const CavityPoint& p : published.u) add(run.velocity(0, 0.5, p.at) - p.value);
  for (const CavityPoint& p : published.v) add(run.velocity(1, p.at, 0.5) - p.value);
  e.rms = std::sqrt(e.rms / double(published.u.size() + published.v.size()));
  return e;
}
inline double cavity_rms(const GridFlow& run) {
  return cavity_error(run, 1000).rms;
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
