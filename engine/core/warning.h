// A system's doubt about its own result: it has not failed, but the result is not trustworthy (a Courant
// number beyond what the method is accurate for, a density off by more than a few percent), with a remedy.
#pragma once
#include <string>

namespace truestep {

struct Warning {
  std::string quantity;         ///< the observable that shows it
  double value = 0, limit = 0;  ///< its value; beyond `limit` the result is not trustworthy
  std::string detail;           ///< one sentence: what is wrong, and the remedy
  double suggested_dt = 0;      ///< s, a step that would be short enough; 0: no step alone would
};

}  // namespace truestep
