// The choice of loops when the program runs.
#include "engine/kernels/sph/wide/cell_loops.h"

namespace truestep::sph {

#if defined(TRUESTEP_AVX512)
const CellLoops& avx512_cell_loops(Smoothing kernel, int dimension);  // avx512_loops.cc

const CellLoops* wide_cell_loops(Smoothing kernel, int dimension) {
  static const bool kWide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                            __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
                            __builtin_cpu_supports("avx512cd");
  return kWide ? &avx512_cell_loops(kernel, dimension) : nullptr;
}
#else
const CellLoops* wide_cell_loops(Smoothing, int) {
  return nullptr;
}
#endif

}  // namespace truestep::sph
