// The smooth surface of a liquid filled by particles. Each particle spreads its volume over an ellipsoid that
// follows its neighbours (after Yu & Turk 2013): with C the weighted covariance of the neighbours' positions
// relative to that in the bulk of the liquid,
//   G = (C + e 1)^-1,   phi(x) = sum V det(G) W(|G (x - x_i)|, h),
// so that sheets are flat, and a lone drop is a ball of its own size. e bounds the stretch in place of their
// clamped eigenvalues, and positions are not smoothed, which would take a layer off the liquid. The surface
// phi = 1/2 is extracted from a lattice by surface nets (Gibson 1998), and its ripples are removed by
// Taubin's smoothing (1995), which preserves the volume.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace truestep {

struct SurfaceOf {
  double spacing = 0;  ///< m, between particles at rest
  double cell = 0;     ///< m, of the lattice; increased if there were more nodes than `most_nodes`
  size_t most_nodes = 8'000'000;
  int smoothing = 6;  ///< rounds
};

struct ParticleSurface {
  std::vector<float> positions;     ///< n x 3, m
  std::vector<float> values;        ///< n, means of the particles' around; empty where these have none
  std::vector<uint32_t> triangles;  ///< 3 each, anticlockwise seen from outside
};

/// The surface around `places` (n x 3, m); non-finite ones are left out. `values` has one number per particle
/// or none. Empty without particles, or if spacing or cell is not above 0.
ParticleSurface particle_surface(std::span<const float> places, std::span<const float> values,
                                 const SurfaceOf& of);

}  // namespace truestep
