// Explicit Runge-Kutta methods as data, one per named method and the only place for their coefficients: fixed
// steps of force fields (runge_kutta.h) and everything else (explicit_pair.h) read the same.
//   K_i = f(t + c_i h, y + h sum_j a_ij K_j),   y' = y + h sum_i b_i K_i,   error = h sum_i e_i K_i.
// Low orders: Hairer, Norsett, Wanner 1993, tables II.1.1 and II.1.2. Pairs: Bogacki, Shampine 1989, "A 3(2)
// pair of Runge-Kutta formulas"; Fehlberg 1969, table III (formula 2, propagating order 5 as Shampine and
// Watts do); Dormand, Prince 1980, table 2; Tsitouras 2011, "Runge-Kutta pairs of order 5(4) satisfying only
// the first column simplifying assumption", table 1. Tests hold every one to its order conditions.
#pragma once
#include <array>
#include <cstddef>

namespace truestep {

struct Tableau {
  static constexpr size_t kMaxStages = 13;
  using Weights = std::array<double, kMaxStages>;
  size_t stages = 1;
  std::array<Weights, kMaxStages> a{};
  Weights b{}, c{};
  int order = 1;
  int error_order = 0;     ///< of the embedded solution b - error; 0: none, the step is fixed
  Weights error{};         ///< b - b^
  Weights second_error{};  ///< of a second embedded solution (dop853), else all 0
  /// Dense output b_i(theta) = sum_p dense[i][p] theta^(p + 1); all 0: cubic Hermite interpolation.
  int dense_order = 3;
  std::array<std::array<double, 4>, 7> dense{};

  /// The last stage is evaluated at the step's result, so that it is the next step's first.
  constexpr bool first_same_as_last() const {
    for (size_t j = 0; j + 1 < stages; ++j) {
      if (a[stages - 1][j] != b[j]) return false;
    }
    return stages > 1 && b[stages - 1] == 0;
  }
  constexpr bool two_errors() const {
    for (const double w : second_error) {
      if (w != 0) return true;
    }
    return false;
  }
};

inline constexpr Tableau kEulerTableau = {.stages = 1, .b = {1}};
inline constexpr Tableau kMidpointTableau = {
    .stages = 2, .a = {{{}, {0.5}}}, .b = {0, 1}, .c = {0, 0.5}, .order = 2};
inline constexpr Tableau kHeunTableau = {
    .stages = 2, .a = {{{}, {1}}}, .b = {0.5, 0.5}, .c = {0, 1}, .order = 2};
inline constexpr Tableau kRk4Tableau = {.stages = 4,
                                        .a = {{{}, {0.5}, {0, 0.5}, {0, 0, 1}}},
                                        .b = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6},
                                        .c = {0, 0.5, 0.5, 1},
                                        .order = 4};

/// One rk4 step of h together with two of h/2 (stages 5 to 7 and 8 to 11; the first is common), with local
/// extrapolation: b = b_half + (b_half - b_whole) / 15. Hairer, Norsett, Wanner 1993, eqs. II.4.3 to II.4.5;
/// the error is the whole difference, as there.
inline constexpr Tableau kStepDoublingTableau = {
    .stages = 11,
    .a = {{{},
           {0.5},
           {0, 0.5},
           {0, 0, 1},
           {0.25},
           {0, 0, 0, 0, 0.25},
           {0, 0, 0, 0, 0, 0.5},
           {1.0 / 12, 0, 0, 0, 1.0 / 6, 1.0 / 6, 1.0 / 12},
           {1.0 / 12, 0, 0, 0, 1.0 / 6, 1.0 / 6, 1.0 / 12, 0.25},
           {1.0 / 12, 0, 0, 0, 1.0 / 6, 1.0 / 6, 1.0 / 12, 0, 0.25},
           {1.0 / 12, 0, 0, 0, 1.0 / 6, 1.0 / 6, 1.0 / 12, 0, 0, 0.5}}},
    .b = {7.0 / 90, -1.0 / 45, -1.0 / 45, -1.0 / 90, 8.0 / 45, 8.0 / 45, 4.0 / 45, 4.0 / 45, 8.0 / 45,
          8.0 / 45, 4.0 / 45},
    .c = {0, 0.5, 0.5, 1, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1},
    .order = 5,
    .error_order = 4,
    .error = {-1.0 / 12, -1.0 / 3, -1.0 / 3, -1.0 / 6, 1.0 / 6, 1.0 / 6, 1.0 / 12, 1.0 / 12, 1.0 / 6, 1.0 / 6,
              1.0 / 12}};

inline constexpr Tableau kBs32Tableau = {
    .stages = 4,
    .a = {{{}, {0.5}, {0, 0.75}, {2.0 / 9, 1.0 / 3, 4.0 / 9}}},
    .b = {2.0 / 9, 1.0 / 3, 4.0 / 9},
    .c = {0, 0.5, 0.75, 1},
    .order = 3,
    .error_order = 2,
    .error = {2.0 / 9 - 7.0 / 24, 1.0 / 3 - 1.0 / 4, 4.0 / 9 - 1.0 / 3, -1.0 / 8}};

inline constexpr Tableau kRkf45Tableau = {
    .stages = 6,
    .a = {{{},
           {1.0 / 4},
           {3.0 / 32, 9.0 / 32},
           {1932.0 / 2197, -7200.0 / 2197, 7296.0 / 2197},
           {439.0 / 216, -8, 3680.0 / 513, -845.0 / 4104},
           {-8.0 / 27, 2, -3544.0 / 2565, 1859.0 / 4104, -11.0 / 40}}},
    .b = {16.0 / 135, 0, 6656.0 / 12825, 28561.0 / 56430, -9.0 / 50, 2.0 / 55},
    .c = {0, 1.0 / 4, 3.0 / 8, 12.0 / 13, 1, 1.0 / 2},
    .order = 5,
    .error_order = 4,
    .error = {1.0 / 360, 0, -128.0 / 4275, -2197.0 / 75240, 1.0 / 50, 2.0 / 55}};

/// Dense output of order 4: Hairer, Norsett, Wanner 1993, eq. II.6.12 (Shampine 1986) as polynomials.
inline constexpr Tableau kDopri5Tableau = {
    .stages = 7,
    .a = {{{},
           {1.0 / 5},
           {3.0 / 40, 9.0 / 40},
           {44.0 / 45, -56.0 / 15, 32.0 / 9},
           {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
           {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
           {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}}},
    .b = {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84, 0},
    .c = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1},
    .order = 5,
    .error_order = 4,
    .error = {71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40},
    .dense_order = 4,
    .dense = {
        {{1, -8048581381.0 / 2820520608, 8663915743.0 / 2820520608, -12715105075.0 / 11282082432},
         {},
         {0, 131558114200.0 / 32700410799, -68118460800.0 / 10900136933, 87487479700.0 / 32700410799},
         {0, -1754552775.0 / 470086768, 14199869525.0 / 1410260304, -10690763975.0 / 1880347072},
         {0, 127303824393.0 / 49829197408, -318862633887.0 / 49829197408, 701980252875.0 / 199316789632},
         {0, -282668133.0 / 205662961, 2019193451.0 / 616988883, -1453857185.0 / 822651844},
         {0, 40617522.0 / 29380423, -110615467.0 / 29380423, 69997945.0 / 29380423}}}};

/// Dense output of order 4 from the same paper, section 3.
inline constexpr Tableau kTsit5Tableau = {
    .stages = 7,
    .a = {{{},
           {0.161},
           {-0.008480655492356989, 0.335480655492357},
           {2.8971530571054935, -6.359448489975075, 4.3622954328695815},
           {5.325864828439257, -11.748883564062828, 7.4955393428898365, -0.09249506636175525},
           {5.86145544294642, -12.92096931784711, 8.159367898576159, -0.071584973281401,
            -0.028269050394068383},
           {0.09646076681806523, 0.01, 0.4798896504144996, 1.379008574103742, -3.290069515436081,
            2.324710524099774}}},
    .b = {0.09646076681806523, 0.01, 0.4798896504144996, 1.379008574103742, -3.290069515436081,
          2.324710524099774},
    .c = {0, 0.161, 0.327, 0.9, 0.9800255409045097, 1, 1},
    .order = 5,
    .error_order = 4,
    .error = {0.09646076681806523 - 0.09468075576583945, 0.01 - 0.009183565540343254,
              0.4798896504144996 - 0.4877705284247616, 1.379008574103742 - 1.234297566930479,
              -3.290069515436081 + 2.7077123499835256, 2.324710524099774 - 1.866628418170587, -1.0 / 66},
    .dense_order = 4,
    .dense = {{{1, -2.763706197274826, 2.9132554618219126, -1.0530884977290216},
               {0, 0.1317, -0.2234, 0.1017},
               {0, 3.9302962368947516, -5.941033872131505, 2.490627285651253},
               {0, -12.411077166933676, 30.33818863028232, -16.548102889244902},
               {0, 37.50931341651104, -88.1789048947664, 47.37952196281928},
               {0, -27.896526289197286, 65.09189467479366, -34.87065786149661},
               {0, 1.5, -4, 2.5}}}};

/// Ten stages of order 4 whose region of stability contains the disc of radius 6 around -6: the longest
/// explicit steps for equations whose fast modes are damped (Ketcheson 2008, "Highly efficient strong
/// stability-preserving Runge-Kutta methods with low-storage implementations", section 4; embedded solution:
/// Conde, Fekete, Shadid 2018, "Embedded error estimation and adaptive step-size control for optimal explicit
/// strong stability preserving Runge-Kutta methods").
inline constexpr Tableau kSsprk104Tableau = [] {
  Tableau t{.stages = 10,
            .b = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1},
            .c = {0, 1.0 / 6, 1.0 / 3, 0.5, 2.0 / 3, 1.0 / 3, 0.5, 2.0 / 3, 5.0 / 6, 1},
            .order = 4,
            .error_order = 3,
            .error = {-0.1, 0.1, 0.1, -0.2, 0.1, 0.1, -0.1, 0.1, -0.2, 0.1}};
  for (size_t i = 1; i < 10; ++i) {
    for (size_t j = 0; j < i; ++j) t.a[i][j] = i >= 5 && j < 5 ? 1.0 / 15 : 1.0 / 6;
  }
  return t;
}();

}  // namespace truestep
