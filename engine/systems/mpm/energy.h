// An elastic law given as text: energy per undeformed volume as an expression of the singular values s1, s2
// (s3) of the deformation gradient, of I1 = sum s^2, I2 = sum of the products of two of them, J = s1 s2 (s3),
// and of the scene's mu and lambda. The stress is its derivative, tau = U diag(s_k dpsi/ds_k) U^T, found
// symbolically.
#pragma once
#include <string>

#include "engine/kernels/mpm/laws.h"
#include "engine/math/expression/rows.h"

namespace truestep::mpm {

class EnergyLaw {
 public:
  /// Error "scene_invalid" with `pointer` if the text is invalid, has kinks or jumps, is not isotropic
  /// (changes when singular values are exchanged), is not finite, or has stress or no stiffness at rest.
  EnergyLaw(const std::string& text, int dimension, const Material& material, const std::string& pointer);

  /// At a deformation gradient; singular values below kLeastVolume are raised to it.
  template <int D, class T>
  Response<D, T> response(const Square<D, T>& f) const {
    using W = Wide<T>;
    Svd<D, T> d = svd(f);
    double s[3][W::kLanes], out[1 + 2 * 3][W::kLanes];
    for (int k = 0; k < D; ++k) {
      d.s[k] = max(d.s[k], W(kLeastVolume));
      for (int lane = 0; lane < W::kLanes; ++lane) s[k][lane] = double{d.s[k][lane]};
    }
    run(s[0], s[1], s[2], W::kLanes, out[0], W::kLanes);
    const auto number = [&](int which) {
      W a;
      for (int lane = 0; lane < W::kLanes; ++lane) a.set(lane, static_cast<T>(out[which][lane]));
      return a;
    };
    W slope[D], bend[D];
    for (int k = 0; k < D; ++k) slope[k] = number(1 + k), bend[k] = number(1 + D + k);
    return principal_response(d, number(0), slope, bend);
  }

 private:
  /// Energy, its first and second derivatives by each singular value, `stride` apart, at `count` points.
  void run(const double* s1, const double* s2, const double* s3, size_t count, double* out,
           size_t stride) const;

  int dimension_;
  ExpressionRows program_;
};

}  // namespace truestep::mpm
