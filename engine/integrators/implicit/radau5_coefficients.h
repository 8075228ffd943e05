// Radau IIA of order 5 and the transformation that splits its linear systems: Hairer, Wanner 1996, eq. IV.5.9
// to IV.8.5; error weights eq. IV.8.18. Tests recompute them from the collocation conditions.
#pragma once
#include <array>

#include "engine/math/complex.h"

namespace truestep::radau5 {

using Matrix = std::array<std::array<double, 3>, 3>;

inline constexpr double kRootSix = 2.449489742783178098197;
inline constexpr double kC1 = (4 - kRootSix) / 10, kC2 = (4 + kRootSix) / 10;

/// Runge-Kutta matrix; its last row holds the weights.
inline constexpr Matrix kA = {
    {{(88 - 7 * kRootSix) / 360, (296 - 169 * kRootSix) / 1800, (-2 + 3 * kRootSix) / 225},
     {(296 + 169 * kRootSix) / 1800, (88 + 7 * kRootSix) / 360, (-2 - 3 * kRootSix) / 225},
     {(16 - kRootSix) / 36, (16 + kRootSix) / 36, 1.0 / 9}}};

/// T^-1 A^-1 T = diag(g, (a -b; b a)): 1/g and 1/(a + i b).
inline constexpr double kInverseGamma = 0.27488882959567736775;
inline constexpr Complex kInverse{0.16255558520216131613, -0.18494932440714078428};

inline constexpr Matrix kT = {{{0.091232394870892942792, -0.14125529502095420843, -0.030029194105147424492},
                               {0.24171793270710701896, 0.20412935229379993199, 0.38294211275726193779},
                               {0.96604818261509293619, 1, 0}}};
inline constexpr Matrix kInverseT = {
    {{4.325579890063155350967, 0.3391992518158098695448, 0.5417705399358748711888},
     {-4.178718591551904727289, -0.3276828207610623870842, 0.4766235545005504519582},
     {-0.502872634945786876047, 2.571926949855605429216, -0.5960392048282249249738}}};

/// Embedded method of order 3: error = (I - z J)^-1 (z f(y) + 1/g sum_k e_k Z_k), z = h / g.
inline constexpr double kE1 = -(13 + 7 * kRootSix) / 3, kE2 = (-13 + 7 * kRootSix) / 3, kE3 = -1.0 / 3;

}  // namespace truestep::radau5
