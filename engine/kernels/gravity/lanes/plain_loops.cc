// The loops for the processors that everything else is compiled for, and the choice between them and wider
// ones.
#include <type_traits>

#include "engine/kernels/gravity/lanes/pair_kernels.h"
#include "engine/math/wide.h"

namespace truestep::gravity {

namespace plain {
namespace {
#include "engine/kernels/gravity/lanes/lanes_plain.h"
#include "engine/kernels/gravity/lanes/pair_loops.h"
}  // namespace
}  // namespace plain

const PairLoops& plain_pair_loops() {
  return plain::kLoops;
}

#if defined(TRUESTEP_AVX512)
const PairLoops& avx512_pair_loops();  // avx512_loops.cc

const PairLoops& pair_loops() {
  static const bool kWide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
  return kWide ? avx512_pair_loops() : plain::kLoops;
}
#else
const PairLoops& pair_loops() {
  return plain::kLoops;
}
#endif

}  // namespace truestep::gravity
