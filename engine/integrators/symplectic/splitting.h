// Symmetric compositions of drifts (x moves with constant v) and kicks (v changes at constant x) as data:
//   drift d_0 h, kick k_1 h, drift d_1 h, kick k_2 h ... drift d_n h.
// Compositions of leapfrogs over w_1 h, w_2 h ... have d_i = (w_i + w_{i+1}) / 2 and k_i = w_i.
//   yoshida4    Yoshida 1990, "Construction of higher order symplectic integrators", eq. 2.13
//   yoshida6    same, table 1, solution A
//   yoshida8    Yoshida's form with 15 leapfrogs and the smaller weights of Suzuki, Umeno 1993
//               (Hairer, Lubich, Wanner 2006, eq. V.3.11)
//   kahan_li8   Kahan, Li 1997, "Composition constants for raising the orders of unconventional schemes",
//               s17odr8a: 17 leapfrogs, an error constant some 20 times smaller
//   pefrl       Omelyan, Mryglod, Folk 2002, "Optimized Forest-Ruth- and Suzuki-like algorithms", eqs. 20, 22
// Tests hold them to the order conditions of Nystroem trees.
#pragma once
#include <array>
#include <cstddef>

namespace truestep {

struct Splitting {
  static constexpr size_t kMax = 17;
  size_t kicks = 1;
  std::array<double, kMax + 1> drift{};
  std::array<double, kMax> kick{};
  int order = 2;
};

/// Composition of leapfrogs with weights w.
template <size_t N>
constexpr Splitting composition(int order, const std::array<double, N>& w) {
  Splitting s;
  s.kicks = N, s.order = order;
  s.drift[0] = 0.5 * w[0], s.drift[N] = 0.5 * w[N - 1];
  for (size_t i = 0; i < N; ++i) s.kick[i] = w[i];
  for (size_t i = 1; i < N; ++i) s.drift[i] = 0.5 * (w[i - 1] + w[i]);
  return s;
}
/// The same from the weights before the middle one: w_1 ... w_m, 1 - 2 sum w, w_m ... w_1.
template <size_t M>
constexpr Splitting palindrome(int order, const std::array<double, M>& w) {
  std::array<double, 2 * M + 1> all{};
  double middle = 1;
  for (size_t i = 0; i < M; ++i) all[i] = all[2 * M - i] = w[i], middle -= 2 * w[i];
  all[M] = middle;
  return composition(order, all);
}

inline constexpr Splitting kLeapfrog = composition<1>(2, {1});
inline constexpr Splitting kYoshida4 = composition<3>(
    4, {1.35120719195965763404768780897, -1.70241438391931526809537561794, 1.35120719195965763404768780897});
inline constexpr Splitting kYoshida6 = palindrome<3>(
    6, {0.784513610477557263819497633, 0.235573213359358133684793183, -1.17767998417887100694641568});
inline constexpr Splitting kYoshida8 = palindrome<7>(
    8, {0.74167036435061295344822780, -0.40910082580003159399730010, 0.19075471029623837995387626,
        -0.57386247111608226665638773, 0.29906418130365592384446354, 0.33462491824529818378495798,
        0.31529309239676659663205666});
inline constexpr Splitting kKahanLi8 = palindrome<8>(
    8, {0.13020248308889008087881763, 0.56116298177510838456196441, -0.38947496264484728640807860,
        0.15884190655515560089621075, -0.39590389413323757733623154, 0.18453964097831570709183254,
        0.25837438768632204729397911, 0.29501172360931029887096624});

inline constexpr Splitting kPefrl = [] {
  constexpr double kXi = 0.1786178958448091, kLambda = -0.2123418310626054, kChi = -0.06626458266981849;
  Splitting s;
  s.kicks = 4, s.order = 4;
  s.drift = {kXi, kChi, 1 - 2 * (kChi + kXi), kChi, kXi};
  s.kick = {0.5 * (1 - 2 * kLambda), kLambda, kLambda, 0.5 * (1 - 2 * kLambda)};
  return s;
}();

}  // namespace truestep
