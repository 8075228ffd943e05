#include "engine/integrators/explicit/arrays.h"

namespace truestep::detail {

double halved_few(std::array<double, kMostHalved>& terms, size_t n) {
  for (size_t i = n; i < (n + 3) / 4 * 4; ++i) terms[i] = 0;
  if (n == 1) return terms[0];
  if (n == 2) return terms[0] + terms[1];
  if (n > 8) {
    for (size_t i = 0; i < 6; ++i) terms[i] += terms[11 - i];
    for (size_t i = 0; i < 3; ++i) terms[i] += terms[5 - i];
    return (terms[0] + terms[2]) + terms[1];
  }
  if (n > 4) {
    for (size_t i = 0; i < 4; ++i) terms[i] += terms[7 - i];
  }
  return (terms[0] + terms[3]) + (terms[1] + terms[2]);
}

}  // namespace truestep::detail
