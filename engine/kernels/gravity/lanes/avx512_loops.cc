// The loops for processors with AVX-512; only this file is compiled for them. It includes nothing that could
// emit a function which others call too.
#include <immintrin.h>

#include "engine/kernels/gravity/lanes/pair_kernels.h"

namespace truestep::gravity {

namespace avx512 {
namespace {
#include "engine/kernels/gravity/lanes/lanes_avx512.h"
#include "engine/kernels/gravity/lanes/pair_loops.h"
}  // namespace
}  // namespace avx512

const PairLoops& avx512_pair_loops();
const PairLoops& avx512_pair_loops() {
  return avx512::kLoops;
}

}  // namespace truestep::gravity
