// The smooth part of Coulomb's sum (ewald.h) through a mesh, n log n instead of atoms times waves (smooth
// particle mesh Ewald; Essmann, Perera, Berkowitz, Darden et al. 1995). Charges are spread with cardinal
// B-splines M_p,
//   Q(g) = sum_i q_i M_p(u_ix - g_x) M_p(u_iy - g_y) M_p(u_iz - g_z),   u = K x/L                (eq. 4.6)
//   U = 1/2 sum_m W(k) B(m) |FFT Q (m)|^2,   W = 4 pi k_e/V exp(-k^2/4 alpha^2)/k^2
//   B = product over axes of |sum_{j<p-1} M_p(j + 1) exp(2 pi i m j/K)|^-2                       (eq. 4.4)
// and forces are the exact gradient of U, except for the net force due to the mesh, which is removed evenly.
// Planes of the mesh are summed by one task each, atoms in order: the same bits for any number of threads.
#pragma once
#include <array>
#include <vector>

#include "engine/kernels/molecular/ewald.h"
#include "engine/math/solvers/fft.h"

namespace truestep::molecular {

struct MeshSetting {
  EwaldSetting ewald;
  int order = 6;                 ///< p: 4, 6 or 8
  std::array<size_t, 3> points;  ///< K, at least p; unchanged when the box changes its size
  friend bool operator==(const MeshSetting&, const MeshSetting&) = default;
};
/// Order and points for forces with an error of about `accuracy` times a neighbour's force.
MeshSetting mesh_setting(const EwaldSetting& s, const Vec3& edges, double accuracy);

/// Keeps its arrays from call to call.
class MeshEwald {
 public:
  /// As EwaldSum::add.
  EwaldEnergy add(const MeshSetting& s, const Vec3& edges, std::span<const double> x,
                  std::span<const double> charge, std::span<double> force, const ThreadArena& arena);

 private:
  static constexpr size_t kMostOrder = 8, kLanes = Fft::kLanes;
  /// Per atom: its last mesh point along each axis, and the splines there and at the p - 1 points before.
  struct Spread {
    std::array<uint32_t, 3> last;
    std::array<std::array<double, kMostOrder>, 3> weight, slope;  // slope: by u
  };
  struct Line {
    Fft::Buffer data, scratch;
  };
  struct Sums {
    double energy = 0, virial = 0;
  };

  void plan(const MeshSetting& s, const Vec3& edges);
  void place(const Vec3& edges, std::span<const double> x, const ThreadArena& arena);
  template <size_t P>
  void spread(std::span<const double> charge, const ThreadArena& arena);
  template <size_t P>
  void gather(const Vec3& edges, std::span<const double> charge, const ThreadArena& arena);
  void transform_z(const ThreadArena& arena);
  void transform_y(const ThreadArena& arena);
  void transform_x(const ThreadArena& arena);
  void transform_z_back(const ThreadArena& arena);
  /// Multiplies by W B and conjugates; returns the energy.
  Sums convolve(const Vec3& edges, const ThreadArena& arena);

  MeshSetting planned_;
  Vec3 edges_;
  std::vector<Fft> ffts_;                          // along x, y, z
  std::array<std::vector<double>, 3> moduli_;      // B's factors along each axis
  size_t z_stride_ = 0, half_ = 0, h_stride_ = 0;  // doubles per row; waves along z that are not conjugates
  std::vector<double> mesh_;                       // K_x x K_y x z_stride: charges, then potential
  std::vector<double> re_, im_;                    // K_x x K_y x h_stride
  std::vector<Spread> spread_;
  std::vector<uint32_t> starts_, by_plane_;  // atoms by their last plane along x
  std::vector<Line> lines_;                  // one per task
  std::vector<Sums> sums_;                   // one per plane
  std::vector<double> force_;                // N, 3 per atom
};

}  // namespace truestep::molecular
