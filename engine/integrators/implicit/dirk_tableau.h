// Coefficients of singly diagonally implicit Runge-Kutta methods, in which at most the first stage is
// explicit and all others share the diagonal element gamma and thus one matrix I - h gamma J:
//   Y_i = y + h sum_{j <= i} a_ij k_j,  k_i = f(t + c_i h, Y_i),  y1 = y + h sum_i b_i k_i
// `error` holds b - b^ of an embedded method, all zero when there is none.
#pragma once
#include <array>
#include <cstddef>

namespace truestep {

struct DirkTableau {
  static constexpr size_t kMax = 5;
  using Row = std::array<double, kMax>;
  size_t stages = 0;
  int order = 0;
  double gamma = 0;
  std::array<Row, kMax> a{};
  Row b{}, c{}, error{};
  int error_order = 0;  ///< the estimate is O(h^error_order)

  constexpr bool explicit_first() const { return a[0][0] == 0; }
  /// y1 is the last stage.
  constexpr bool stiffly_accurate() const { return a[stages - 1] == b; }
};

// clang-format off
/// L-stable, order 4(3). Hairer, Wanner 1996, table IV.6.5.
inline constexpr DirkTableau kSdirk4 = {
    .stages = 5, .order = 4, .gamma = 0.25,
    .a = {{{0.25},
           {0.5, 0.25},
           {17.0 / 50, -1.0 / 25, 0.25},
           {371.0 / 1360, -137.0 / 2720, 15.0 / 544, 0.25},
           {25.0 / 24, -49.0 / 48, 125.0 / 16, -85.0 / 12, 0.25}}},
    .b = {25.0 / 24, -49.0 / 48, 125.0 / 16, -85.0 / 12, 0.25},
    .c = {0.25, 0.75, 11.0 / 20, 0.5, 1},
    .error = {25.0 / 24 - 59.0 / 48, -49.0 / 48 + 17.0 / 96, 125.0 / 16 - 225.0 / 32, 0, 0.25},
    .error_order = 4};

/// Trapezoidal rule to (2 - sqrt 2) h, then BDF2: L-stable, order 2(3). Bank et al. 1985 as a DIRK method with
/// the embedded formula of Hosea, Shampine 1996, table 1.
inline constexpr double kRootTwo = 1.41421356237309504880;
inline constexpr DirkTableau kTrBdf2 = {
    .stages = 3, .order = 2, .gamma = 1 - kRootTwo / 2,
    .a = {{{},
           {1 - kRootTwo / 2, 1 - kRootTwo / 2},
           {kRootTwo / 4, kRootTwo / 4, 1 - kRootTwo / 2}}},
    .b = {kRootTwo / 4, kRootTwo / 4, 1 - kRootTwo / 2},
    .c = {0, 2 - kRootTwo, 1},
    .error = {kRootTwo / 4 - (1 - kRootTwo / 4) / 3, kRootTwo / 4 - (3 * kRootTwo / 4 + 1) / 3,
              1 - kRootTwo / 2 - (1 - kRootTwo / 2) / 3},
    .error_order = 3};

/// Y = y + h f(Y): L-stable, order 1. Hairer, Wanner 1996, eq. IV.3.1.
inline constexpr DirkTableau kImplicitEuler = {
    .stages = 1, .order = 1, .gamma = 1, .a = {{{1}}}, .b = {1}, .c = {1}};

/// Y = y + h/2 f(Y), y1 = y + h f(Y): symplectic, order 2. Hairer, Lubich, Wanner 2006, eq. I.1.7.
inline constexpr DirkTableau kImplicitMidpoint = {
    .stages = 1, .order = 2, .gamma = 0.5, .a = {{{0.5}}}, .b = {1}, .c = {0.5}};

/// y1 = y + h/2 (f(y) + f(y1)), order 2. Hairer, Wanner 1996, eq. IV.3.
inline constexpr DirkTableau kTrapezoid = {
    .stages = 2, .order = 2, .gamma = 0.5, .a = {{{}, {0.5, 0.5}}}, .b = {0.5, 0.5}, .c = {0, 1}};
// clang-format on

}  // namespace truestep
