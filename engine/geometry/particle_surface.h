// The smooth surface of a liquid that particles fill. Each particle spreads its volume over an ellipsoid that
// follows its neighbours (after Yu & Turk 2013): with C the weighted covariance of the neighbours' places
// over that in the midst of the liquid,
//   G = (C + e 1)^-1,   phi(x) = sum V det(G) W(|G (x - x_i)|, h),
// so that sheets are flat, and a lone drop is a ball of its own size. e bounds the stretch in place of their
// clamped eigenvalues, and places are not smoothed, which would take a layer off the liquid. The surface phi
// = 1/2 is taken off a lattice by surface nets (Gibson 1998), and its ripples by Taubin's smoothing (1995),
// which keeps the volume.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace truestep {

struct SurfaceOf {
  double spacing = 0;  ///< m, between particles at rest
  double cell = 0;     ///< m, of the lattice; made larger where there were more nodes than `most_nodes`
  size_t most_nodes = 8'000'000;
  int smoothing = 6;  ///< rounds
};

struct ParticleSurface {
  std::vector<float> positions;     ///< n x 3, m
  std::vector<float> values;        ///< n, means of the particles' around; empty where these have none
  std::vector<uint32_t> triangles;  ///< 3 each, anticlockwise seen from outside
};

/// Of `places` (n x 3, m); those that are not finite are left out. `values` has a number a particle or none.
/// Empty without particles, or where spacing or cell is not above 0.
ParticleSurface particle_surface(std::span<const float> places, std::span<const float> values,
                                 const SurfaceOf& of);

}  // namespace truestep
