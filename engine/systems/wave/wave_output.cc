// Parts, fields, observables and drawing of waves.
#include "engine/systems/wave/wave.h"

namespace truestep::wave {

FieldView Wave::field(const State& s, size_t, size_t which, std::vector<double>&) const {
  const auto c = static_cast<State::Column>(which);
  return {s.f64(c).data(), Scalar::f64, s.rows(c), 1};
}

}  // namespace truestep::wave
