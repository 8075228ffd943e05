// One substep of a liquid with a surface: particles carry it, the grid computes its pressure.
//   spread: velocities and fill from particles to faces and cells (kernels/mac/particles.h)
//   project: u + h force - grad phi with div u = 0 in the liquid, phi = 0 at the surface
//            (kernels/mac/surface.h), and the displacement that undoes compression: lap psi = -(fill -
//            1), dx = -grad psi (Kugelstadt, Longva, Thuerey, Bender 2019, "Implicit density projection for
//            volume conserving liquids"; here with the same cells and matrix as the pressure)
//   apply_viscosity: viscosity, before the pressure (face_viscosity.h)
//   carry: what particles keep of their own velocity (Zhu, Bridson 2005; Jiang et al. 2015), paths by the
//          midpoint rule through the new velocity, extrapolated beyond the surface
//   pay_for_lift: what the displacement has lifted a connected body of liquid by is taken from its motion
//                 (liquid_energy.cc)
// Scratch of one thread's run; everything that lasts is in the state.
#pragma once
#include "engine/kernels/mac/surface.h"
#include "engine/lattice/solvers/cut_poisson.h"
#include "engine/neighbours/cell_order.h"
#include "engine/systems/grid_fluid/flow.h"
#include "engine/systems/grid_fluid/liquid/face_viscosity.h"
#include "engine/systems/grid_fluid/liquid/given_flow.h"
#include "engine/systems/grid_fluid/liquid/room.h"

namespace truestep::grid_fluid {

/// The arrays of a state that a liquid changes.
struct LiquidFields {
  size_t rows = 0;
  double *position = nullptr, *velocity = nullptr;  ///< m, m/s; three per particle
  double* affine = nullptr;                         ///< 1/s; d x d per particle; null: flip
  double *pressure = nullptr, *fill = nullptr;      ///< m^2/s^2 and 1, in cells
  double* lifted = nullptr;                         ///< m^2/s^2, energy over the mass of a particle
  double* owed = nullptr;  ///< m^2/s^2, per particle: what it has not paid for yet; null without gravity
};

/// Results of the last substep.
struct LiquidReport {
  lattice::CutPoisson::Outcome pressure, density;
  int viscosity_iterations = 0;  ///< of the component that took most
  double mean_compression = 0, max_compression = 0;
};

class LiquidFlow {
 public:
  /// `most`: particles at once; `inlets` must outlive it.
  void bind(const FlowModel& model, std::span<const LiquidInlet> inlets, size_t most,
            const ThreadArena& arena);

  /// Copies the particles out of the state, and back; those that have left the box are then beyond its sides.
  void load(const LiquidFields& f);
  void store(LiquidFields& f);
  /// 1/s, cells crossed by the fastest particle or obstacle at time t (s), summed over the axes.
  double crossing_rate(double t);
  LiquidReport substep(LiquidFields& f, double t, double h);
  /// Where liquid comes in, placed for the last substep.
  const GivenFlow& given() const { return given_; }

 private:
  using Array = std::vector<double, CacheLineAllocator<double>>;
  template <size_t D>
  void sort();
  template <size_t D>
  void spread(LiquidFields& f);
  /// m^2/s^2 summed over the particles, by which their displacement lifts them.
  template <size_t D>
  double carry(double h);
  /// Finds the connected bodies of liquid, while the pressure's matrix is at hand.
  void number_bodies();
  void pay_for_lift(double h);
  void settle_faces(double t, double h);
  void find_surface(LiquidFields& f);
  void apply_viscosity(double h, LiquidReport& report);
  void project(LiquidFields& f, double h, LiquidReport& report);
  void take_back_compression(LiquidFields& f, LiquidReport& report);
  void open_sides(size_t c);
  void accelerate_beside(size_t c);
  void continue_outwards();
  /// Places obstacles for time t (s).
  void place_obstacles(double t);
  void fill_velocity(size_t c, double* u);
  void fill_sides(size_t c, double* u) { mac::fill_ghosts(model_->grid, c, sides_[c], u, *arena_); }
  /// Keeps a particle (in cells) in the box, wrapping periodic axes; `leave`: unless a side lets it out.
  enum class Beyond : uint8_t { stay, leave };
  template <size_t D>
  void hold(double* x, Beyond beyond) const;
  bool lets_out(size_t axis, size_t end, const double* x) const;
  template <size_t D>
  bool in_nozzle(double* x, double h) const;
  double* particle(Array& from, size_t p) const { return from.data() + width_ * p; }
  /// f(offset, low cell's offset, side) for the faces of a component; side: the sign of the inward direction
  /// on the box's sides that are no outflow, 0 elsewhere.
  template <class F>
  void for_faces(size_t c, F&& f) const;
  void clear_of_obstacles(double* x, double* v) const;

  const FlowModel* model_ = nullptr;
  const ThreadArena* arena_ = nullptr;
  size_t rows_ = 0, most_ = 0,
         width_ = 0;  ///< width_: numbers per particle: position in cells, velocity, slopes, what it owes
  bool affine_ = false, lifts_ = false;  ///< lifts_: there is gravity
  std::array<mac::Sides, 3> sides_;      ///< faces on the box's sides keep their values
  mac::Sides cell_sides_;
  Array now_, sorted_;  ///< particles, in any order and sorted by cell
  std::vector<uint32_t> row_, rows_sorted_;
  CellOrder order_;                                          ///< of `now_`, by cell
  std::array<Array, 3> u_, before_, mass_, factor_, shift_;  ///< on faces
  std::array<std::vector<uint8_t>, 3> known_;                ///< faces that have a velocity
  std::vector<uint8_t> liquid_, fresh_;
  Array depth_, work_;
  Room room_;
  struct Excess {
    double sum = 0, most = 0, cells = 0;
  };
  std::vector<Excess> excess_;  ///< of the fill of a row of cells
  /// Sums over a connected body of liquid, then what becomes of its particles.
  struct LiquidBody {
    double particles = 0, owed = 0, moving = 0;  ///< m^2/s^2: owed, at last by each particle; moving
    double mean[3] = {};                         ///< m/s
    double keep = 1;                             ///< of the motion relative to the mean
  };
  std::vector<LiquidBody> bodies_;     ///< by number; 0: none
  std::vector<uint32_t> body_, runs_;  ///< number of a cell's body; scratch
  std::array<std::vector<double>, 3> force_;
  std::optional<lattice::CutPoisson> solver_;
  FaceViscosity viscosity_;
  MovingSolids solids_;
  GivenFlow given_;
};

template <class F>
void LiquidFlow::for_faces(size_t c, F&& f) const {
  const mac::MacGrid& g = model_->grid;
  const size_t s = g.stride(c), n = g.cells[c];
  const auto& kinds = model_->kinds[c];
  const int low_side = g.periodic[c] || kinds[0] == SideKind::outflow ? 0 : 1;
  const int high_side = g.periodic[c] || kinds[1] == SideKind::outflow ? 0 : -1;
  mac::for_rows(g, c, *arena_, [&](size_t at, size_t j, size_t k, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      const size_t place = c == 0 ? i : c == 1 ? j : k;
      f(at + i, at + i - s, place == 0 ? low_side : place == n ? high_side : 0);
    }
  });
}

}  // namespace truestep::grid_fluid
