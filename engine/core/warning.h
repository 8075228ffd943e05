// What a system says of its own result: it has not failed, but it is not to be trusted either (a courant
// number beyond what the method is accurate for, a density off by more than a few percent), with what would
// do.
#pragma once
#include <string>

namespace truestep {

struct Warning {
  std::string quantity;         ///< the observable that says so
  double value = 0, limit = 0;  ///< of it; beyond `limit` the result is not to be trusted
  std::string detail;           ///< one sentence: what is wrong and what would do
  double suggested_dt = 0;      ///< s, of the step that would do; 0: no step alone would
};

}  // namespace truestep
