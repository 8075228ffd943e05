// Numbers about a state that a scientist plots: energies, momenta, residuals, counts.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace truestep {

struct Observation {
  std::string name;  ///< dotted, e.g. "energy.kinetic"
  double value = 0;
  std::string unit;  ///< SI
};

class Observables {
 public:
  void add(std::string_view name, double value, std::string_view unit) {
    rows_.push_back({std::string(name), value, std::string(unit)});
  }
  const std::vector<Observation>& rows() const { return rows_; }
  std::optional<double> find(std::string_view name) const {
    for (const Observation& o : rows_) {
      if (o.name == name) return o.value;
    }
    return std::nullopt;
  }

 private:
  std::vector<Observation> rows_;
};

}  // namespace truestep
