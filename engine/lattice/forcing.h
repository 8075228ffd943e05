// The texts of a scene on a lattice as programs: initial values, coefficient, source and the values of sides,
// with the derivatives that the sides need. What does not depend on u in
//   u_t = div(c grad u) + s    or    u_tt = div(c grad u) - k u_t + s
// is the forcing b(t): the source; 2 c g / spacing at Neumann and Robin nodes; at Dirichlet nodes the first
// or second derivative of the given value, so that they are unknowns like all others and methods keep their
// order there. With fourth order in space, mirrored nodes beyond a side also get what the equation itself
// says about the next derivative there: u_nn = (D g - s) / c - g_yy - g_zz at Dirichlet sides, u_nnn = (D g -
// s_n) / c - g_yy - g_zz at Neumann sides, D being d/dt or d^2/dt^2 + k d/dt.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "engine/core/state.h"
#include "engine/lattice/diffusion.h"
#include "engine/lattice/lattice_def.h"
#include "engine/math/expression/rows.h"

namespace truestep::lattice {

struct Texts {
  std::vector<std::pair<std::string, std::string>> initial;  ///< JSON pointer and text, one per field
  std::pair<std::string, std::string> coefficient, source;
  enum class Squared : uint8_t { no, yes } squared = Squared::no;  ///< the coefficient is that of a speed
  int time_order = 1;                                              ///< u_t or u_tt
};

/// Numbers that commands may change.
struct Constants {
  double coefficient = 1;  ///< where it is constant
  double damping = 0;      ///< k
  friend bool operator==(const Constants&, const Constants&) = default;
};

class LatticeModel {
 public:
  /// Error "scene_invalid" with every fault of the texts.
  LatticeModel(const LatticeDef& def, SideKind usual, const Texts& texts);

  const Lattice& lattice() const { return lattice_; }
  int order() const { return order_; }
  /// The number that the coefficient's text is, already squared; nothing: it varies.
  std::optional<double> constant_coefficient() const { return constant_coefficient_; }
  bool coefficient_moves() const { return coefficient_.time; }
  /// Whether a source or the value of a side differs from 0: then energy is not the system's own.
  bool forced() const { return forced_; }

  /// Initial values of field `which`; Dirichlet nodes hold their sides' values (or rates of change).
  std::vector<double> initial(size_t which) const;
  /// Root mean square over the box of how far u is from the exact solution at t; nothing where the scene
  /// gives none.
  std::optional<double> distance_from_exact(std::span<const double> u, double t) const;
  /// Sampled for any lattice on the same box.
  Coefficient coefficient(const Lattice& on, const Constants& constants, double t) const;

 private:
  friend class Forcing;
  struct Program {
    ExpressionRows rows;
    bool time = false, zero = true;
  };
  /// Nodes of one side whose values are its own, with their coordinates.
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

/// b(t) with what stays the same kept from call to call. Scratch of one thread.
class Forcing {
 public:
  /// The model must outlive this; `operator_` gives coefficients at sides.
  void bind(const LatticeModel& model, const Diffusion& diffusion, const Constants& constants);
  /// out += b(t); Dirichlet nodes are set.
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
