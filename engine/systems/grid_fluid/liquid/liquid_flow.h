// One substep of a liquid with a surface: its particles carry it, the grid gives it its pressure.
//   spread: velocities and fill from particles to faces and cells (kernels/mac/particles.h)
//   project: u + h force - grad phi with div u = 0 where there is liquid, phi = 0 at the surface
//            (kernels/mac/surface.h), and the displacement that takes compression back: lap psi = -(fill -
//            1), dx = -grad psi (Kugelstadt, Longva, Thuerey, Bender 2019, "Implicit density projection for
//            volume conserving liquids"; here with the same cells and matrix as the pressure)
//   apply_viscosity: viscosity, before the pressure (face_viscosity.h)
//   carry: what particles keep of their own velocity (Zhu, Bridson 2005; Jiang et al. 2015), paths by the
//          midpoint rule through the new velocity, continued beyond the surface.
// Scratch of one thread's run; everything that lasts is in the state.
#pragma once
#include "engine/kernels/mac/surface.h"
#include "engine/lattice/cut_poisson.h"
#include "engine/systems/grid_fluid/flow.h"
#include "engine/systems/grid_fluid/liquid/face_viscosity.h"

namespace truestep::grid_fluid {

/// Arrays of a state that a liquid moves.
struct LiquidFields {
  size_t rows = 0;
  double *position = nullptr, *velocity = nullptr;  ///< m, m/s; three a particle
  double* affine = nullptr;                         ///< 1/s; d x d a particle; null: flip
  double *pressure = nullptr, *fill = nullptr;      ///< m^2/s^2 and 1, in cells
};

/// What the last substep found.
struct LiquidReport {
  lattice::CutPoisson::Outcome pressure, density;
  int viscosity_iterations = 0;  ///< of the component that took most
  double mean_compression = 0, max_compression = 0;
};

class LiquidFlow {
 public:
  void bind(const FlowModel& model, size_t rows, const ThreadArena& arena);

  /// Takes the particles out of the state, and puts them back.
  void load(const LiquidFields& f);
  void store(LiquidFields& f);
  /// 1/s, cells that the fastest particle or obstacle crosses at time t (s), summed over the axes.
  double crossing_rate(double t);
  LiquidReport substep(LiquidFields& f, double t, double h);

 private:
  using Array = std::vector<double, CacheLineAllocator<double>>;
  template <size_t D>
  void sort();
  template <size_t D>
  void spread(LiquidFields& f);
  template <size_t D>
  void carry(double h);
  void settle_faces(double t, double h);
  void find_surface(LiquidFields& f);
  void apply_viscosity(double h, LiquidReport& report);
  void project(LiquidFields& f, double h, LiquidReport& report);
  void take_back_compression(LiquidFields& f, LiquidReport& report);
  void accelerate_beside(size_t c);
  void continue_outwards();
  void measure_room();
  /// Obstacles as they are at time t (s).
  void place_obstacles(double t);
  void fill_sides(size_t c, double* u) { mac::fill_ghosts(model_->grid, c, sides_[c], u, *arena_); }
  double* particle(Array& from, size_t p) const { return from.data() + width_ * p; }
  /// f(offset, low cell's offset, side) for the faces of a component; side: the sign of inwards on the box's
  /// sides, 0 elsewhere.
  template <class F>
  void for_faces(size_t c, F&& f) const;
  void clear_of_obstacles(double* x, double* v) const;

  const FlowModel* model_ = nullptr;
  const ThreadArena* arena_ = nullptr;
  size_t rows_ = 0, width_ = 0;  ///< numbers a particle: place in cells, velocity, slopes
  bool affine_ = false;
  std::array<mac::Sides, 3> sides_;  ///< faces on the box's sides keep their values
  mac::Sides cell_sides_;
  Array now_, sorted_;  ///< particles, in any order and in that of cells
  std::vector<uint32_t> row_, rows_sorted_, cell_, first_;
  std::array<Array, 3> u_, before_, mass_, factor_, shift_;  ///< on faces
  std::array<std::vector<uint8_t>, 3> known_;                ///< faces that have a velocity
  std::vector<uint8_t> liquid_, fresh_;
  Array room_, depth_, work_;  ///< room: what the weights of liquid at rest add up to in a cell
  double whole_ = 1;           ///< the same far from everything
  std::array<std::vector<double>, 3> force_;
  std::optional<lattice::CutPoisson> solver_;
  FaceViscosity viscosity_;
  MovingSolids solids_;
};

template <class F>
void LiquidFlow::for_faces(size_t c, F&& f) const {
  const mac::MacGrid& g = model_->grid;
  const size_t s = g.stride(c), n = g.cells[c];
  mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t k, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      const size_t place = c == 0 ? i : c == 1 ? j : k;
      f(at + i, at + i - s, g.periodic[c] ? 0 : place == 0 ? 1 : place == n ? -1 : 0);
    }
  });
}

}  // namespace truestep::grid_fluid
