// Rows of finite-difference stencils on a lattice with constant coefficients, x running fastest:
//   out[i] = centre u[i] + x1 (u[i-1] + u[i+1]) + x2 (u[i-2] + u[i+2]) + sum_m w[m] row[m][i].
// Neighbours along y and z are pointers to their rows, so that reflecting sides, periodic sides and one-sided
// weights are just a choice of pointers and weights and cost nothing inside the loop. With the identity in
// `centre` and the step size in every weight, the same loop is a whole step of explicit Euler. Coefficients
// of derivatives: Fornberg 1988, "Generation of finite difference formulas on arbitrarily spaced grids",
// tables 1 and 2.
#pragma once
#include <array>
#include <cstddef>
#include <utility>

namespace truestep::stencil {

/// Second derivative times the square of the spacing: weights of u[i], u[i -+ 1] and u[i -+ 2].
struct SecondDerivative {
  double centre, near, far;
};
inline constexpr SecondDerivative kOrder2{-2, 1, 0}, kOrder4{-5.0 / 2, 4.0 / 3, -1.0 / 12};

/// Weights of one row; `rows` and `weights` have Rows entries.
struct RowWeights {
  double centre = 0, near = 0, far = 0;
  const double* rows[8] = {};
  double weights[8] = {};
};

/// Elements [begin, end) of a row, all at least Reach (1 or 2) from both of its ends.
template <int Reach, int Rows>
inline void combine_row(const double* u, const RowWeights& w, double* out, size_t begin, size_t end) {
  const double centre = w.centre, near = w.near, far = w.far;
  // Written out because gcc does not unroll a loop over rows inside the loop over elements.
  [&]<size_t... M>(std::index_sequence<M...>) {
    [[maybe_unused]] const std::array<const double*, Rows> rows = {w.rows[M]...};
    [[maybe_unused]] const std::array<double, Rows> weights = {w.weights[M]...};
#pragma GCC ivdep
    for (size_t i = begin; i < end; ++i) {
      double sum = centre * u[i] + near * (u[i - 1] + u[i + 1]);
      if constexpr (Reach == 2) sum += far * (u[i - 2] + u[i + 2]);
      ((sum += std::get<M>(weights) * std::get<M>(rows)[i]), ...);
      out[i] = sum;
    }
  }
  (std::make_index_sequence<Rows>());
}

/// A neighbour along y or z of a row with variable coefficients: its row, and the coefficients of the faces
/// between the two, element by element.
struct Neighbour {
  const double* row = nullptr;
  const double* face = nullptr;
  double scale = 0;  ///< 1 / spacing^2
};

/// out[i] = identity u[i] + step sum over neighbours of face (neighbour - u[i]) / spacing^2 for i in [begin,
/// end); face[i] of the row itself lies between i and i + 1. Conservative: whatever leaves one node through a
/// face enters the other.
template <int Rows>
inline void conserve_row(const double* u, const double* face, double scale, const Neighbour* neighbours,
                         double identity, double step, double* out, size_t begin, size_t end) {
  [&]<size_t... M>(std::index_sequence<M...>) {
    [[maybe_unused]] const std::array<const double*, Rows> rows = {neighbours[M].row...},
                                                           faces = {neighbours[M].face...};
    [[maybe_unused]] const std::array<double, Rows> scales = {neighbours[M].scale...};
#pragma GCC ivdep
    for (size_t i = begin; i < end; ++i) {
      double sum = scale * (face[i] * (u[i + 1] - u[i]) + face[i - 1] * (u[i - 1] - u[i]));
      ((sum += std::get<M>(scales) * (std::get<M>(faces)[i] * (std::get<M>(rows)[i] - u[i]))), ...);
      out[i] = identity * u[i] + step * sum;
    }
  }
  (std::make_index_sequence<Rows>());
}

}  // namespace truestep::stencil
