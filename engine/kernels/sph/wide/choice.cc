// The choice of loops when the program runs.
#include "engine/kernels/sph/wide/cell_loops.h"
#include "engine/kernels/sph/wide/sum_loops.h"

namespace truestep::sph {

#if defined(TRUESTEP_AVX512)
const CellLoops& avx512_cell_loops(Smoothing kernel, int dimension);  // avx512_loops.cc
const SumLoops& avx512_sum_loops();

namespace {
bool has_avx512() {
  static const bool kHas = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
                           __builtin_cpu_supports("avx512cd");
  return kHas;
}
}  // namespace

const CellLoops* wide_cell_loops(Smoothing kernel, int dimension) {
  return has_avx512() ? &avx512_cell_loops(kernel, dimension) : nullptr;
}
const SumLoops* wide_sum_loops() {
  return has_avx512() ? &avx512_sum_loops() : nullptr;
}
#else
const CellLoops* wide_cell_loops(Smoothing, int) {
  return nullptr;
}
const SumLoops* wide_sum_loops() {
  return nullptr;
}
#endif

}  // namespace truestep::sph
