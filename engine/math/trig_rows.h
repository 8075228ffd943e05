// Sine and cosine of many numbers at once, with the bits of trig::sin and trig::cos.
#pragma once
#include <cstddef>

namespace truestep::trig {

/// out[k] = sin x[k], k < n; out may be x.
void sin_rows(const double* x, double* out, size_t n);
/// out[k] = cos x[k], k < n; out may be x.
void cos_rows(const double* x, double* out, size_t n);

}  // namespace truestep::trig
