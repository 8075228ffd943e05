// The expressions of a scene on a lattice, compiled: initial values, coefficient, source and the values of
// sides, with the derivatives that the sides need. The part of
//   u_t = div(c grad u) + s    or    u_tt = div(c grad u) - k u_t + s
// that does not depend on u is the forcing b(t): the source; 2 c g / spacing at Neumann and Robin nodes; at
// Dirichlet nodes the first or second derivative of the given value, so that they are unknowns like all
// others and methods keep their order there. With fourth order in space, the mirrored nodes beyond a side
// also include the next derivative there as given by the equation itself: u_nn = (D g - s) / c - g_yy - g_zz
// at Dirichlet sides, u_nnn = (D g - s_n) / c - g_yy - g_zz at Neumann sides, where D is d/dt or d^2/dt^2 +
// k d/dt.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "engine/core/state/state.h"
#include "engine/lattice/diffusion.h"
#include "engine/lattice/lattice_def.h"
#include "engine/math/expression/rows.h"

namespace truestep::lattice {

struct Texts {
  std::vector<std::pair<std::string, std::string>> initial;  ///< JSON pointer and text, one per field
  std::pair<std::string, std::string> coefficient, source;
  /// Whether the coefficient is given as a speed, to be squared.
  enum class Squared : uint8_t { no, yes } squared = Squared::no;
  int time_order = 1;  ///< u_t or u_tt
};

/// Constants that commands may change.
struct Constants {
  double coefficient = 1;  ///< value of a constant coefficient
  double damping = 0;      ///< k
  friend bool operator==(const Constants&, const Constants&) = default;
};

class LatticeModel {
 public:
  /// Error "scene_invalid" with all errors in the texts.
  LatticeModel(const LatticeDef& def, SideKind usual, const Texts& texts);

  const Lattice& lattice() const { return lattice_; }
  int order() const { return order_; }
  /// The coefficient if its text is a constant, already squared; empty if it varies.
  std::optional<double> constant_coefficient() const { return constant_coefficient_; }
  bool coefficient_moves() const { return coefficient_.time; }
  /// Whether a source or a side's value differs from 0: the system then exchanges energy with the outside.
  bool forced() const { return forced_; }

  /// Initial values of field `which`; Dirichlet nodes have their sides' values (or rates of change).
  std::vector<double> initial(size_t which) const;
  /// Root mean square difference over the box between u and the exact solution at t; empty if the scene gives
  /// none.
  std::optional<double> distance_from_exact(std::span<const double> u, double t) const;
  /// Sampled for any lattice on the same box.
  Coefficient coefficient(const Lattice& on, const Constants& constants, double t) const;

 private:
  friend class Forcing;
  struct Program {
    ExpressionRows rows;
    bool time = false, zero = true;
  };
  /// Nodes of one side whose values are given by this side, with their coordinates.
  struct Face {
    size_t axis = 0, end = 0;
    SideKind kind = SideKind::dirichlet;
    double transfer = 0;
    std::vector<uint32_t> nodes;
    std::vector<double> x, y, z;
    /// g, dg/dt, d^2g/dt^2, and the derivative along the normal that order 4 needs.
    Program values;
  };
  void run(const Program& p, const Face& face, const Constants& c, double t, std::vector<double>& out) const;

  Lattice lattice_;
  int order_ = 2, time_order_ = 1;
  std::vector<Program> initial_;
  Program coefficient_, source_;
  std::optional<Program> exact_;
  std::vector<Face> faces_;
  std::optional<double> constant_coefficient_;
  bool forced_ = false;
  std::array<std::vector<double>, 3> coordinates_;
};

/// b(t), with the parts that do not change cached between calls. Scratch of one thread.
class Forcing {
 public:
  /// `model` and `diffusion` must outlive this; `diffusion` gives the coefficients at the sides.
  void bind(const LatticeModel& model, const Diffusion& diffusion, const Constants& constants);
  /// out += b(t); Dirichlet nodes are set instead.
  void add(double t, double* out, const ThreadArena& arena);

 private:
  void side(const LatticeModel::Face& face, double t, std::vector<std::pair<uint32_t, double>>& sums,
            std::vector<std::pair<uint32_t, double>>& given);

  const LatticeModel* model_ = nullptr;
  const Diffusion* diffusion_ = nullptr;
  Constants constants_;
  std::vector<double> source_, moving_source_, values_;
  std::vector<std::pair<uint32_t, double>> steady_, steady_given_, moving_, moving_given_;
};

}  // namespace truestep::lattice
